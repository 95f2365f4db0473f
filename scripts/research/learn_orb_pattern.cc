// Learns the descriptor's sampling pattern and prints it as src/alidade/features/orb_pattern.inc.
//
// Rublee et al. 2011, §4.3: evaluates all candidate tests on many patches, sorts them by the
// distance of their mean from 0.5, and selects them greedily unless they correlate with a selected
// one above a threshold, which is raised until 256 are found. There are two differences. Candidates
// are pairs of single pixels of the smoothed level (the paper: pairs of 5x5 boxes). The order also
// considers how often a test's result changes between two views of the same corner: tests are
// sorted by 2 p (1 - p) - 1.2 flips, where 2 p (1 - p) is the probability that two different
// corners give different results, and flips the probability that two views of one corner do.
//
// Patches come from generated images only, by the "dead leaves" model: opaque shapes with power-law
// sizes occlude each other. Their edges, corners and spectra are similar to those of photographs
// (Lee, Mumford & Huang 2001).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/features/describe.h"
#include "alidade/features/extractor.h"
#include "alidade/features/frame.h"
#include "alidade/features/pyramid.h"
#include "alidade/features/smooth.h"
#include "alidade/features/spread.h"

namespace alidade {
namespace {

constexpr int kPictures = 80;
constexpr int kWidth = 640, kHeight = 480;
constexpr size_t kCandidates = 20000;
constexpr int kBits = 256;
constexpr double kShortest = 5;  // pixels, the width of the smoothing: closer pixels hardly differ
constexpr double kStability = 1.2;  // weight of flips in a test's score

constexpr int kReach = kPatternReach, kSide = 2 * kReach + 1;

struct Test {
  int x0, y0, x1, y1;
};

cv::Mat DeadLeaves(Random& random) {
  cv::Mat picture(kHeight, kWidth, CV_8UC1, cv::Scalar(128));
  const int shapes = 1500;
  for (int i = 0; i < shapes; ++i) {
    // Sizes with density ~ r^-3 between 4 and 150 pixels, for scale invariance.
    const double u = random.Uniform(), low = 4, high = 150;
    const double r = 1 / std::sqrt((1 - u) / (low * low) + u / (high * high));
    const cv::Point2d centre(random.Uniform(0, kWidth), random.Uniform(0, kHeight));
    const double turn = random.Uniform(0, 2 * std::numbers::pi);
    const double shade = random.Uniform(20, 235);
    constexpr int kSubpixels = 4;  // bits of fraction
    const auto fixed = [&](double x, double y) {
      return cv::Point(static_cast<int>(std::lround(x * (1 << kSubpixels))),
                       static_cast<int>(std::lround(y * (1 << kSubpixels))));
    };
    std::vector<cv::Point> outline;
    const int kind = static_cast<int>(random.Below(3));
    const int corners = kind == 0 ? 4 : kind == 1 ? 3 + static_cast<int>(random.Below(5)) : 40;
    const double flat = random.Uniform(0.25, 1);
    for (int k = 0; k < corners; ++k) {
      const double angle =
          2 * std::numbers::pi * (k + (kind == 1 ? random.Uniform(-0.3, 0.3) : 0.5)) / corners;
      const double x = r * std::cos(angle), y = r * flat * std::sin(angle);
      outline.push_back(fixed(centre.x + x * std::cos(turn) - y * std::sin(turn),
                              centre.y + x * std::sin(turn) + y * std::cos(turn)));
    }
    cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{outline}, cv::Scalar(shade),
                 cv::LINE_AA, kSubpixels);
  }
  // Illumination gradient, and fine texture.
  cv::Mat grain(kHeight / 2, kWidth / 2, CV_32FC1);
  for (int y = 0; y < grain.rows; ++y) {
    for (int x = 0; x < grain.cols; ++x)
      grain.at<float>(y, x) = static_cast<float>(random.Gaussian());
  }
  cv::resize(grain, grain, picture.size(), 0, 0, cv::INTER_CUBIC);
  const double slope_x = random.Uniform(-0.3, 0.3), slope_y = random.Uniform(-0.3, 0.3);
  const double strength = random.Uniform(0, 6);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double light =
          1 + slope_x * (x - kWidth / 2.0) / kWidth + slope_y * (y - kHeight / 2.0) / kHeight;
      picture.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(picture.at<uint8_t>(y, x) * light +
                                                             strength * grain.at<float>(y, x));
    }
  }
  return picture;
}

// Simulates the camera: lens blur and noise.
cv::Mat Photograph(const cv::Mat& picture, Random& random) {
  cv::Mat photo;
  const double sigma = random.Uniform(0.5, 1.3), noise = random.Uniform(1, 5);
  cv::GaussianBlur(picture, photo, cv::Size(), sigma);
  const double gain = random.Uniform(0.85, 1.15);
  for (int y = 0; y < photo.rows; ++y) {
    for (int x = 0; x < photo.cols; ++x) {
      photo.at<uint8_t>(y, x) =
          cv::saturate_cast<uint8_t>(gain * photo.at<uint8_t>(y, x) + noise * random.Gaussian());
    }
  }
  return photo;
}

struct Patch {
  cv::Mat smooth;  // the whole level
  int x, y;
  double place_x, place_y;  // on level 0
  int level;
  float angle;
};

std::vector<Patch> FindPatches(const cv::Mat& photo) {
  std::vector<Patch> patches;
  const std::vector<cv::Mat> pyramid = BuildPyramid(photo);
  for (int l = 0; l < kPyramidLevels; ++l) {
    cv::Mat fine(pyramid[l].size(), CV_8UC1), smooth(pyramid[l].size(), CV_8UC1);
    SmoothBinomial(pyramid[l], 0, fine);
    SmoothBox(fine, 0, smooth);
    const ExtractorSettings settings;
    std::vector<Corner> corners = FastCorners(fine, settings.fast_minimum, settings.border,
                                              settings.border, fine.rows - settings.border);
    corners = StrongPerCell(corners, fine.size(), settings.border, settings.cell,
                            settings.fast_threshold);
    corners = SpreadCorners(corners, fine.size(), static_cast<int>(300 / ScaleOfLevel(l)),
                            settings.evenness);
    const double scale = ScaleOfLevel(l);
    for (const Corner& c : corners) {
      patches.push_back({smooth, c.x, c.y, ToLevelZero(c.x, scale), ToLevelZero(c.y, scale), l,
                         PatchAngle(pyramid[l], c.x, c.y)});
    }
  }
  return patches;
}

// Results of all tests, one bit per patch: answers[test][patch / 64].
class Answers {
 public:
  explicit Answers(size_t tests) : words_(tests) {}
  void Add(const std::vector<Test>& tests, const Patch& patch) {
    // Rotates the patch, then evaluates the tests.
    const double turn = 2 * std::numbers::pi / SteeredPattern::kTurns;
    const double angle = std::round(patch.angle / turn) * turn;
    const double c = std::cos(angle), s = std::sin(angle);
    std::array<std::array<uint8_t, kSide>, kSide> upright{};
    for (int y = -kReach; y <= kReach; ++y) {
      for (int x = -kReach; x <= kReach; ++x) {
        if (x * x + y * y > kReach * kReach) continue;
        upright[y + kReach][x + kReach] =
            patch.smooth.at<uint8_t>(patch.y + static_cast<int>(std::lround(s * x + c * y)),
                                     patch.x + static_cast<int>(std::lround(c * x - s * y)));
      }
    }
    const auto at = [&](int x, int y) { return upright[y + kReach][x + kReach]; };
    if (count_ % 64 == 0) {
      for (auto& w : words_) w.push_back(0);
    }
    for (size_t t = 0; t < tests.size(); ++t) {
      const uint64_t bit = at(tests[t].x0, tests[t].y0) < at(tests[t].x1, tests[t].y1);
      words_[t].back() |= bit << (count_ % 64);
    }
    ++count_;
  }
  double Mean(size_t test) const {
    int64_t ones = 0;
    for (uint64_t w : words_[test]) ones += std::popcount(w);
    return static_cast<double>(ones) / count_;
  }
  const std::vector<uint64_t>& words(size_t test) const { return words_[test]; }
  int count() const { return count_; }

 private:
  std::vector<std::vector<uint64_t>> words_;
  int count_ = 0;
};

// Share of patches on which two tests differ.
double Differ(const std::vector<uint64_t>& a, const std::vector<uint64_t>& b, int count) {
  int64_t ones = 0;
  for (size_t i = 0; i < a.size(); ++i) ones += std::popcount(a[i] ^ b[i]);
  return static_cast<double>(ones) / count;
}

int Run() {
  Random random(2011);
  std::vector<Test> tests;
  const auto place = [&](int& x, int& y) {
    do {
      x = static_cast<int>(random.Below(2 * kReach + 1)) - kReach;
      y = static_cast<int>(random.Below(2 * kReach + 1)) - kReach;
    } while (x * x + y * y > kReach * kReach);
  };
  while (tests.size() < kCandidates) {
    Test t;
    place(t.x0, t.y0);
    place(t.x1, t.y1);
    if (std::hypot(t.x0 - t.x1, t.y0 - t.y1) >= kShortest) tests.push_back(t);
  }

  // Two views of each image: patches of the first, each paired with the same corner in the second.
  Answers first(tests.size()), second(tests.size());
  for (int i = 0; i < kPictures; ++i) {
    const cv::Mat picture = DeadLeaves(random);
    const double angle = random.Uniform(-0.6, 0.6), zoom = std::exp(random.Uniform(-0.2, 0.2));
    const double shear = random.Uniform(-0.15, 0.15);
    const cv::Matx23d view(zoom * std::cos(angle), -zoom * std::sin(angle) + shear, 0,
                           zoom * std::sin(angle), zoom * std::cos(angle), 0);
    cv::Matx23d centred = view;
    centred(0, 2) = kWidth / 2.0 - view(0, 0) * kWidth / 2.0 - view(0, 1) * kHeight / 2.0;
    centred(1, 2) = kHeight / 2.0 - view(1, 0) * kWidth / 2.0 - view(1, 1) * kHeight / 2.0;
    cv::Mat turned;
    cv::warpAffine(picture, turned, centred, picture.size(), cv::INTER_CUBIC,
                   cv::BORDER_REFLECT_101);
    const std::vector<Patch> a = FindPatches(Photograph(picture, random));
    const std::vector<Patch> b = FindPatches(Photograph(turned, random));
    for (const Patch& p : a) {
      const double x = centred(0, 0) * p.place_x + centred(0, 1) * p.place_y + centred(0, 2);
      const double y = centred(1, 0) * p.place_x + centred(1, 1) * p.place_y + centred(1, 2);
      const Patch* nearest = nullptr;
      double best = 1.5 * ScaleOfLevel(p.level);
      for (const Patch& q : b) {
        // The level at which the corner should appear, or a neighboring one.
        if (std::abs(q.level - p.level - std::log(zoom) / std::log(kPyramidScale)) > 1) continue;
        const double d = std::hypot(q.place_x - x, q.place_y - y);
        if (d < best) {
          best = d;
          nearest = &q;
        }
      }
      if (nearest == nullptr) continue;
      first.Add(tests, p);
      second.Add(tests, *nearest);
    }
  }

  std::vector<double> worth(tests.size()), mean(tests.size());
  std::vector<int> order(tests.size());
  for (size_t t = 0; t < tests.size(); ++t) {
    const double p = mean[t] = first.Mean(t);
    worth[t] =
        2 * p * (1 - p) - kStability * Differ(first.words(t), second.words(t), first.count());
    order[t] = static_cast<int>(t);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return worth[a] > worth[b]; });

  std::vector<int> taken;
  double limit = 0.2;
  for (; taken.size() < kBits; limit += 0.05) {
    taken.clear();
    for (int t : order) {
      const bool independent = std::all_of(taken.begin(), taken.end(), [&](int other) {
        // Phi coefficient of two results.
        const double p = mean[t], q = mean[other];
        const double d = Differ(first.words(t), first.words(other), first.count());
        const double both = (p + q - d) / 2;
        const double phi = (both - p * q) / std::sqrt(p * (1 - p) * q * (1 - q));
        return std::abs(phi) <= limit;
      });
      if (independent) taken.push_back(t);
      if (taken.size() == kBits) break;
    }
  }
  double mean_flip = 0, mean_spread = 0;
  for (int t : taken) {
    mean_flip += Differ(first.words(t), second.words(t), first.count()) / kBits;
    mean_spread += std::abs(first.Mean(t) - 0.5) / kBits;
  }
  std::printf(
      "// Made by scripts/research/make_orb_pattern; do not edit. x0, y0, x1, y1 in pixels of the "
      "patch.\n");
  std::printf("// %d patches, correlation <= %.2f, mean |p - 0.5| %.3f, mean flips %.3f.\n",
              first.count(), limit - 0.05, mean_spread, mean_flip);
  for (size_t i = 0; i < taken.size(); ++i) {
    const Test& t = tests[taken[i]];
    std::printf("{%d, %d, %d, %d},%s", t.x0, t.y0, t.x1, t.y1, i % 5 == 4 ? "\n" : " ");
  }
  std::printf("\n");
  return 0;
}

}  // namespace
}  // namespace alidade

int main() { return alidade::Run(); }
