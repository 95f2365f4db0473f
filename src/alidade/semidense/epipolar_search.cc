#include "alidade/semidense/epipolar_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>

namespace alidade {
namespace {

constexpr int kHalf = 2;  // the pattern compared is 2 kHalf + 1 samples along the line
constexpr int kPattern = 2 * kHalf + 1;
constexpr int kMargin = kHalf + 1;  // samples needed beyond the places compared
constexpr int kShift = 5;           // fractional bits of samples
constexpr int kOne = 1 << kShift;
constexpr int kMaxPlaces = 256;  // compared on one line, at most: pixels
constexpr int kLanes = 4;

// Intensity in the low half, gradient magnitude in the high half, so that one multiplication
// weighs both.
inline uint32_t Spread(const uint8_t* pixel) {
  return static_cast<uint32_t>(pixel[0]) | static_cast<uint32_t>(pixel[1]) << 16;
}

// Both values at a place between pixels, times kOne.
inline uint32_t Sample(const cv::Mat& values, float x, float y) {
  const int xi = static_cast<int>(x), yi = static_cast<int>(y);
  const auto wx = static_cast<uint32_t>((x - static_cast<float>(xi)) * 8);
  const auto wy = static_cast<uint32_t>((y - static_cast<float>(yi)) * kOne);
  const uint8_t* p = values.ptr<uint8_t>(yi) + 2 * xi;
  const uint8_t* q = p + values.step[0];
  const uint32_t top = Spread(p) * (8 - wx) + Spread(p + 2) * wx;
  const uint32_t bottom = Spread(q) * (8 - wx) + Spread(q + 2) * wx;
  return (top * (kOne - wy) + bottom * wy) >> 3 & 0x1fff1fff;
}

struct Directions {
  std::array<float, GradientImage::kTurn> x, y;
  Directions() {
    for (int i = 0; i < GradientImage::kTurn; ++i) {
      x[i] = static_cast<float>(std::cos(2 * CV_PI * i / GradientImage::kTurn));
      y[i] = static_cast<float>(std::sin(2 * CV_PI * i / GradientImage::kTurn));
    }
  }
};

// One line after the other, with what they share.
class LineSearch {
 public:
  LineSearch(const EpipolarPair& pair, const Camera& camera, const SemiDenseSettings& settings);
  Hypothesis Search(const EdgePixel& pixel, const DepthRange::Interval& range, SearchCount& count);

 private:
  // What is sought: the reference around the pixel, one step there being one place on the line.
  void TakePattern(const EdgePixel& pixel, float step_x, float step_y);
  // Samples of the line at kMargin places before the first and after the last.
  void WalkLine(int first, int places, float across, float slope);
  int BestPlace(int places, int* second);

  const EpipolarPair& pair_;
  const SemiDenseSettings& settings_;
  Directions directions_;
  Eigen::Matrix3f M_;  // pixel of the reference at infinity to the other's
  Eigen::Vector3f b_,
      epipole_;          // other camera's shift by inverse depth; its centre in the reference
  float least_cosine_;   // of the angle between gradient and line
  int turn_, max_turn_;  // of the picture in its plane, and allowed beside it; in steps
  int width_, height_;
  bool along_x_ = true;
  std::array<int16_t, 2 * kPattern> pattern_;  // intensity and gradient, interleaved
  std::array<int16_t, 2 * (kMaxPlaces + 2 * kMargin + kLanes)> line_{};
  std::array<int32_t, kMaxPlaces + kLanes> costs_;
};

LineSearch::LineSearch(const EpipolarPair& pair, const Camera& camera,
                       const SemiDenseSettings& settings)
    : pair_(pair), settings_(settings), width_(camera.width), height_(camera.height) {
  Eigen::Matrix3d K;
  K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Se3& T = pair.T_other_reference;
  M_ = (K * T.R * K.inverse()).cast<float>();
  b_ = (K * T.t).cast<float>();
  epipole_ = (K * T.Inverse().t).cast<float>();
  least_cosine_ = static_cast<float>(std::cos(settings.max_edge_angle * CV_PI / 180));
  const double turn = std::atan2(T.R(1, 0) - T.R(0, 1), T.R(0, 0) + T.R(1, 1));
  turn_ = static_cast<int>(std::lround(turn / (2 * CV_PI) * GradientImage::kTurn));
  max_turn_ = static_cast<int>(settings.max_turn / 360 * GradientImage::kTurn);
}

void LineSearch::TakePattern(const EdgePixel& pixel, float step_x, float step_y) {
  const auto gain = static_cast<float>(pair_.gain),
             offset = static_cast<float>(pair_.offset) * kOne;
  for (int k = -kHalf; k <= kHalf; ++k) {
    const uint32_t sample = Sample(pair_.reference->values,
                                   static_cast<float>(pixel.x) + static_cast<float>(k) * step_x,
                                   static_cast<float>(pixel.y) + static_cast<float>(k) * step_y);
    const float intensity = static_cast<float>(sample & 0xffff) * gain + offset;
    const float gradient = static_cast<float>(sample >> 16) * gain;
    pattern_[2 * (k + kHalf)] = static_cast<int16_t>(intensity);
    pattern_[2 * (k + kHalf) + 1] = static_cast<int16_t>(std::min(gradient, 255.0f * kOne));
  }
}

void LineSearch::WalkLine(int first, int places, float across, float slope) {
  const cv::Mat& values = pair_.other->values;
  const auto row = static_cast<std::ptrdiff_t>(values.step[0]);
  const std::ptrdiff_t along = along_x_ ? 2 : row, beside = along_x_ ? row : 2;
  const int n = places + 2 * kMargin;
  const uint8_t* line = values.ptr<uint8_t>() + (first - kMargin) * along;
  // Fixed point with 16 fractional bits.
  auto position = static_cast<int32_t>((across - static_cast<float>(kMargin) * slope) * 65536);
  const auto step = static_cast<int32_t>(slope * 65536);
  for (int i = 0; i < n; ++i) {
    const uint8_t* p = line + (position >> 16) * beside;
    const uint32_t w = static_cast<uint32_t>(position & 0xffff) >> (16 - kShift);
    const uint32_t sum = Spread(p) * (kOne - w) + Spread(p + beside) * w;
    line_[2 * i] = static_cast<int16_t>(sum & 0xffff);
    line_[2 * i + 1] = static_cast<int16_t>(sum >> 16);
    line += along;
    position += step;
  }
}

int LineSearch::BestPlace(int places, int* second) {
  std::array<cv::v_int16x8, kPattern> pattern;
  for (int k = 0; k < kPattern; ++k) {
    const int16_t i = pattern_[2 * k], g = pattern_[2 * k + 1];
    pattern[k] = cv::v_int16x8(i, g, i, g, i, g, i, g);
  }
  for (int t = 0; t < places; t += kLanes) {
    cv::v_int32x4 sum = cv::v_setzero_s32();
    for (int k = 0; k < kPattern; ++k) {
      // The first place lies kMargin samples in, and its pattern begins kHalf before it.
      const cv::v_int16x8 d = cv::v_load(&line_[2 * (t + k + kMargin - kHalf)]) - pattern[k];
      sum = sum + cv::v_dotprod(d, d);
    }
    cv::v_store(&costs_[t], sum);
  }
  int best = 0;
  for (int t = 1; t < places; ++t) {
    if (costs_[t] < costs_[best]) best = t;
  }
  *second = -1;
  for (int t = 1; t + 1 < places; ++t) {
    if (std::abs(t - best) < 2 || costs_[t] > costs_[t - 1] || costs_[t] > costs_[t + 1]) continue;
    if (*second < 0 || costs_[t] < costs_[*second]) *second = t;
  }
  return best;
}

Hypothesis LineSearch::Search(const EdgePixel& pixel, const DepthRange::Interval& range,
                              SearchCount& count) {
  const Eigen::Vector3f p(pixel.x, pixel.y, 1);
  // The epipolar line in the reference, and the gradient across it.
  Eigen::Vector2f line(epipole_.x() - epipole_.z() * p.x(), epipole_.y() - epipole_.z() * p.y());
  const float length = line.norm();
  if (!(length > 1e-9f)) return {};
  line /= length;
  const int direction = pair_.reference->direction.at<uint8_t>(pixel.y, pixel.x);
  const float cosine =
      std::abs(directions_.x[direction] * line.x() + directions_.y[direction] * line.y());
  if (cosine < least_cosine_) return {};

  // Where it is for the nearest, the farthest and a middle depth.
  const Eigen::Vector3f a = M_ * p;
  const Eigen::Vector3f far = a + range.min * b_, near = a + range.max * b_;
  constexpr float kInFront = 0.1f;
  if (far.z() < kInFront || near.z() < kInFront) return {};
  const Eigen::Vector2f from = far.head<2>() / far.z(), to = near.head<2>() / near.z();
  along_x_ = std::abs(to.x() - from.x()) >= std::abs(to.y() - from.y());
  const int axis = along_x_ ? 0 : 1;
  const Eigen::Vector3f middle = a + 0.5f * (range.min + range.max) * b_;
  const Eigen::Vector3f moved = M_ * Eigen::Vector3f(line.x(), line.y(), 0);
  const float stretch =
      (moved[axis] * middle.z() - middle[axis] * moved.z()) / (middle.z() * middle.z());
  if (std::abs(stretch) < 0.4f || std::abs(stretch) > 2.5f) return {};

  // Whole pixels along the axis the line follows more; what lies between is found across it.
  const float u0 = from[axis], u1 = to[axis], v0 = from[1 - axis], v1 = to[1 - axis];
  const float extent = u1 - u0;
  if (std::abs(extent) < 1e-3f) return {};
  const float slope = (v1 - v0) / extent;
  const int limit_u = along_x_ ? width_ : height_, limit_v = along_x_ ? height_ : width_;
  if (!(std::abs(u0) < 1e5f && std::abs(u1) < 1e5f)) return {};
  int first = std::max(static_cast<int>(std::floor(std::min(u0, u1))) - 1, kMargin);
  int last = std::min(static_cast<int>(std::ceil(std::max(u0, u1))) + 1, limit_u - 1 - kMargin);
  // Across, too, it must stay in the picture.
  if (std::abs(slope) > 1e-6f) {
    const float at_low = u0 + (1 - v0) / slope,
                at_high = u0 + (static_cast<float>(limit_v) - 3 - v0) / slope;
    first = std::max(
        first, static_cast<int>(std::ceil(std::max(-1.0f, std::min(at_low, at_high)))) + kMargin);
    last = std::min(
        last, static_cast<int>(std::floor(std::min(1e5f, std::max(at_low, at_high)))) - kMargin);
  } else if (v0 < 1 || v0 > static_cast<float>(limit_v) - 3) {
    return {};
  }
  const int places = last - first + 1;
  if (places < 3 || places > kMaxPlaces) return {};

  ++count.searches;
  count.samples += places;
  const float px = static_cast<float>(pixel.x), py = static_cast<float>(pixel.y);
  const float reach_x = std::abs(line.x() / stretch) * kHalf,
              reach_y = std::abs(line.y() / stretch) * kHalf;
  if (px < reach_x || py < reach_y || px + reach_x > static_cast<float>(width_ - 2) ||
      py + reach_y > static_cast<float>(height_ - 2))
    return {};
  TakePattern(pixel, line.x() / stretch, line.y() / stretch);
  WalkLine(first, places, v0 + (static_cast<float>(first) - u0) * slope, slope);
  int second = -1;
  const int best = BestPlace(places, &second);
  if (best == 0 || best == places - 1) return {};
  if (second >= 0 && static_cast<double>(costs_[second]) < settings_.ambiguity * costs_[best])
    return {};

  // Gauss-Newton on the pattern for the place between the pixels (eq. 10).
  const int16_t* s = &line_[2 * (best + kMargin)];
  float gradient2 = 0, product = 0;
  for (int k = -kHalf; k <= kHalf; ++k) {
    for (int c = 0; c < 2; ++c) {
      const float g = 0.5f * static_cast<float>(s[2 * (k + 1) + c] - s[2 * (k - 1) + c]);
      const float r = static_cast<float>(pattern_[2 * (k + kHalf) + c] - s[2 * k + c]);
      gradient2 += g * g;
      product += g * r;
    }
  }
  if (gradient2 < 1) return {};
  const float shift = product / gradient2;
  if (std::abs(shift) > 1) return {};
  const float mean_residual2 = (static_cast<float>(costs_[best]) - product * shift) /
                               static_cast<float>(2 * kPattern * kOne * kOne);
  if (mean_residual2 > settings_.max_residual * settings_.max_residual) return {};
  const float u = static_cast<float>(first + best) + shift;
  const float v = v0 + (u - u0) * slope;

  // The match looks the same way, but for the turn of the picture.
  const int iu = static_cast<int>(u + 0.5f), iv = static_cast<int>(v + 0.5f);
  const int there = along_x_ ? pair_.other->direction.at<uint8_t>(iv, iu)
                             : pair_.other->direction.at<uint8_t>(iu, iv);
  if (there == GradientImage::kUnusable) return {};
  int turned = (there - direction - turn_) % GradientImage::kTurn;
  if (turned < 0) turned += GradientImage::kTurn;
  if (std::min(turned, GradientImage::kTurn - turned) > max_turn_) return {};

  // eq. 8, and its derivative by the place along the axis.
  const float denominator = u * b_.z() - b_[axis];
  const float numerator = a[axis] - u * a.z();
  if (std::abs(denominator) < 1e-12f) return {};
  const float inverse_depth = numerator / denominator;
  if (!(inverse_depth > 0)) return {};
  const float by_place = (-a.z() * denominator - numerator * b_.z()) / (denominator * denominator);
  const float noise = static_cast<float>(settings_.intensity_sigma) * kOne;
  const float geometric = static_cast<float>(settings_.line_sigma) / cosine;
  const float sigma_place = std::sqrt(2 * noise * noise / gradient2 + geometric * geometric);
  return {inverse_depth, std::abs(by_place) * sigma_place};
}

}  // namespace

SearchCount SearchEpipolarLines(const EpipolarPair& pair, const Camera& camera,
                                const DepthRange& range, const SemiDenseSettings& settings,
                                size_t begin, std::span<Hypothesis> found) {
  SearchCount count;
  LineSearch search(pair, camera, settings);
  for (size_t i = 0; i < found.size(); ++i) {
    const EdgePixel& pixel = pair.reference->edges[begin + i];
    const DepthRange::Interval interval = range.At(pixel.x, pixel.y);
    found[i] = interval.max > interval.min ? search.Search(pixel, interval, count) : Hypothesis{};
  }
  return count;
}

}  // namespace alidade
