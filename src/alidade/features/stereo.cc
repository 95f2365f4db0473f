// Depth of keypoints from the right image of a rectified pair.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/features/extractor.h"
#include "alidade/features/pyramid.h"

namespace alidade {
namespace {

constexpr int kMaxDistance = 75;        // bits
constexpr float kRowTolerance = 2;      // pixels of the right keypoint's level
constexpr int kWindow = 5;              // half side of the compared windows, pixels of the level
constexpr int kSlide = 5;               // pixels of the level each way
constexpr double kMinDisparity = 0.1;   // pixels: farther than bf / this is no measurement
constexpr double kOutlier = 1.5 * 1.4;  // medians of the SAD
constexpr int kChunk = 64;

// Right keypoints by the row they stand on, widened by the tolerance.
std::vector<std::vector<int>> RowTable(const Frame& right, int rows) {
  std::vector<std::vector<int>> table(rows);
  for (int i = 0; i < static_cast<int>(right.keypoints.size()); ++i) {
    const Keypoint& k = right.keypoints[i];
    const float reach = kRowTolerance * static_cast<float>(ScaleOfLevel(k.level));
    const int first = std::max(0, static_cast<int>(std::floor(k.y - reach)));
    const int last = std::min(rows - 1, static_cast<int>(std::ceil(k.y + reach)));
    for (int row = first; row <= last; ++row) table[row].push_back(i);
  }
  return table;
}

// Sum of absolute differences of two windows, each less its centre's value (exposures may differ).
int WindowDifference(const cv::Mat& left, int xl, const cv::Mat& right, int xr, int y) {
  const int offset = left.at<uint8_t>(y, xl) - right.at<uint8_t>(y, xr);
  int sum = 0;
  for (int v = -kWindow; v <= kWindow; ++v) {
    const uint8_t* l = left.ptr<uint8_t>(y + v) + xl;
    const uint8_t* r = right.ptr<uint8_t>(y + v) + xr;
    for (int u = -kWindow; u <= kWindow; ++u) sum += std::abs(l[u] - r[u] - offset);
  }
  return sum;
}

struct Disparity {
  double pixels = 0;    // of level 0
  int difference = -1;  // SAD; -1 = not found
};

Disparity Refine(const Frame& left, const Keypoint& k, const Frame& right, float right_x) {
  const cv::Mat& l = left.pyramid[k.level];
  const cv::Mat& r = right.pyramid[k.level];
  const double scale_x = static_cast<double>(left.image.cols) / l.cols;
  const double scale_y = static_cast<double>(left.image.rows) / l.rows;
  const double exact_x = FromLevelZero(k.raw_x, scale_x);
  const int xl = static_cast<int>(std::lround(exact_x));
  const int y = static_cast<int>(std::lround(FromLevelZero(k.raw_y, scale_y)));
  const int xr = static_cast<int>(std::lround(FromLevelZero(right_x, scale_x)));
  const int reach = kWindow + kSlide + 1;
  if (y < kWindow || y >= l.rows - kWindow || xl < kWindow || xl >= l.cols - kWindow) return {};
  if (xr < reach || xr >= r.cols - reach) return {};
  std::array<int, 2 * kSlide + 1> difference;
  for (int s = -kSlide; s <= kSlide; ++s) {
    difference[s + kSlide] = WindowDifference(l, xl, r, xr + s, y);
  }
  const int best =
      static_cast<int>(std::min_element(difference.begin(), difference.end()) - difference.begin());
  if (best == 0 || best == 2 * kSlide) return {};
  const double before = difference[best - 1], here = difference[best], after = difference[best + 1];
  const double curvature = before + after - 2 * here;
  const double shift = curvature > 0 ? (before - after) / (2 * curvature) : 0;
  return {(xl - (xr + best - kSlide + shift)) * scale_x, difference[best]};
}

}  // namespace

void MatchStereo(const Frame& right, const Camera& camera, Frame& left) {
  if (left.pyramid.empty() || right.pyramid.empty()) ThrowUsage("stereo: both pyramids are needed");
  if (left.image.size() != right.image.size()) {
    ThrowInput("stereo: left and right image differ in size");
  }
  const std::vector<std::vector<int>> table = RowTable(right, left.image.rows);
  const double bf = camera.bf();
  const double max_disparity = camera.fx;  // nothing nearer than the baseline is seen by both
  const int count = static_cast<int>(left.keypoints.size());
  std::vector<Disparity> found(left.keypoints.size());
  ParallelFor((count + kChunk - 1) / kChunk, [&](int chunk) {
    for (int i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
      const Keypoint& k = left.keypoints[i];
      const int row = static_cast<int>(std::lround(k.y));
      if (row < 0 || row >= left.image.rows) continue;
      int best = -1, distance = kMaxDistance + 1;
      for (int j : table[row]) {
        const Keypoint& c = right.keypoints[j];
        const double disparity = k.x - c.x;
        const double slack = ScaleOfLevel(k.level);  // whole pixels of the level
        if (std::abs(c.level - k.level) > 1 || disparity < -slack || disparity > max_disparity) {
          continue;
        }
        const int d = HammingDistance(left.descriptors[i], right.descriptors[j]);
        if (d < distance) {
          distance = d;
          best = j;
        }
      }
      if (best >= 0) found[i] = Refine(left, k, right, right.keypoints[best].raw_x);
    }
  });

  std::vector<int> differences;
  for (const Disparity& d : found) {
    if (d.difference >= 0) differences.push_back(d.difference);
  }
  double limit = 0;
  if (!differences.empty()) {
    const auto middle = differences.begin() + static_cast<int>(differences.size()) / 2;
    std::nth_element(differences.begin(), middle, differences.end());
    limit = kOutlier * *middle;
  }
  for (int i = 0; i < count; ++i) {
    Keypoint& k = left.keypoints[i];
    const Disparity& d = found[i];
    const bool good = d.difference >= 0 && d.difference <= limit && d.pixels >= kMinDisparity &&
                      d.pixels <= max_disparity;
    k.depth = good ? static_cast<float>(bf / d.pixels) : Keypoint::kNoDepth;
    k.right_x = good ? static_cast<float>(k.x - d.pixels) : Keypoint::kNoDepth;
  }
}

}  // namespace alidade
