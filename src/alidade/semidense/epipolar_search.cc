#include "alidade/semidense/epipolar_search.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>

#include "alidade/semidense/pixel_transfer.h"

namespace alidade {
namespace {

constexpr int kShift = 5;  // fractional bits of samples
constexpr int kOne = 1 << kShift;
// Smallest ratio of the depth in the other camera to the depth in the reference.
constexpr float kInFront = 0.1f;

// Intensity in the low half, gradient magnitude in the high half, so that one multiplication
// interpolates both.
inline uint32_t Spread(const uint8_t* pixel) {
  return static_cast<uint32_t>(pixel[0]) | static_cast<uint32_t>(pixel[1]) << 16;
}

inline int Intensity(uint32_t sample) { return static_cast<int>(sample & 0xffff); }
inline int Gradient(uint32_t sample) { return static_cast<int>(sample >> 16); }

constexpr int kFixed = 16;  // fractional bits of positions

inline int32_t ToFixed(float x) { return static_cast<int32_t>(x * (1 << kFixed)); }

// Both values at a sub-pixel position, times kOne.
inline uint32_t Sample(const uint8_t* values, std::ptrdiff_t row, int32_t x, int32_t y) {
  const uint32_t wx = static_cast<uint32_t>(x & 0xffff) >> (kFixed - 3);
  const uint32_t wy = static_cast<uint32_t>(y & 0xffff) >> (kFixed - kShift);
  const uint8_t* p = values + (y >> kFixed) * row + 2 * (x >> kFixed);
  const uint8_t* q = p + row;
  const uint32_t top = Spread(p) * (8 - wx) + Spread(p + 2) * wx;
  const uint32_t bottom = Spread(q) * (8 - wx) + Spread(q + 2) * wx;
  return (top * (kOne - wy) + bottom * wy) >> 3 & 0x1fff1fff;
}

struct Directions {
  std::array<float, GradientImage::kTurn> x, y;
  Directions() {
    for (size_t i = 0; i < x.size(); ++i) {
      x[i] =
          static_cast<float>(std::cos(2 * CV_PI * static_cast<double>(i) / GradientImage::kTurn));
      y[i] =
          static_cast<float>(std::sin(2 * CV_PI * static_cast<double>(i) / GradientImage::kTurn));
    }
  }
};

const Directions& AllDirections() {
  static const Directions directions;
  return directions;
}

}  // namespace

EpipolarSearch::EpipolarSearch(const EpipolarPair& pair, const Camera& camera,
                               const SemiDenseSettings& settings)
    : pair_(pair), settings_(settings), width_(camera.width), height_(camera.height) {
  const Se3& T = pair.T_other_reference;
  const PixelTransfer to_other(camera, T);
  M_ = to_other.at_infinity;
  b_ = to_other.shift;
  epipole_ = PixelTransfer(camera, T.Inverse()).shift;
  least_cosine_ = static_cast<float>(std::cos(settings.max_edge_angle * CV_PI / 180));
  const double turn = std::atan2(T.R(1, 0) - T.R(0, 1), T.R(0, 0) + T.R(1, 1));
  turn_ = static_cast<int>(std::lround(turn / (2 * CV_PI) * GradientImage::kTurn));
  max_turn_ = static_cast<int>(settings.max_turn / 360 * GradientImage::kTurn);
}

Hypothesis EpipolarSearch::Search(const EdgePixel& pixel, std::span<const DepthInterval> intervals,
                                  SearchCount& count) {
  DepthInterval whole = intervals.front();
  for (const DepthInterval& interval : intervals) {
    whole.min = std::min(whole.min, interval.min);
    whole.max = std::max(whole.max, interval.max);
  }
  Line line;
  if (!Prepare(pixel, whole, line) || !TakePattern(pixel, line)) return {};
  ++count.searches;
  Match match;
  for (const DepthInterval& interval : intervals) SearchInterval(line, interval, count, match);
  return match.cost >= 0 ? Refine(line, match) : Hypothesis{};
}

// Part of the interval in front of the other camera. `a_z`: z of Line::a.
DepthInterval EpipolarSearch::InFront(DepthInterval interval, float a_z) const {
  if (std::abs(b_.z()) < 1e-6f) return a_z < kInFront ? DepthInterval{} : interval;
  const float limit = (kInFront - a_z) / b_.z();
  if (b_.z() < 0) {
    interval.max = std::min(interval.max, limit);
  } else {
    interval.min = std::max(interval.min, limit);
  }
  return interval;
}

// Returns false if depth is not observable along the line at this pixel.
bool EpipolarSearch::Prepare(const EdgePixel& pixel, const DepthInterval& whole, Line& line) {
  const Eigen::Vector3f p(pixel.x, pixel.y, 1);
  line.direction = {epipole_.x() - epipole_.z() * p.x(), epipole_.y() - epipole_.z() * p.y()};
  const float length = line.direction.norm();
  if (!(length > 1e-9f)) return false;
  line.direction /= length;
  line.gradient_step = pair_.reference->direction.at<uint8_t>(pixel.y, pixel.x);
  const Directions& directions = AllDirections();
  line.cosine = std::abs(directions.x[line.gradient_step] * line.direction.x() +
                         directions.y[line.gradient_step] * line.direction.y());
  if (line.cosine < least_cosine_) return false;

  line.a = M_ * p;
  const DepthInterval seen = InFront(whole, line.a.z());
  if (seen.empty()) return false;
  const Eigen::Vector3f far = line.a + seen.min * b_, near = line.a + seen.max * b_;
  const Eigen::Vector2f path = near.head<2>() / near.z() - far.head<2>() / far.z();
  axis_ = std::abs(path.x()) >= std::abs(path.y()) ? 0 : 1;
  // Displacement of the match per step in the reference, at a medium depth.
  const Eigen::Vector3f middle = line.a + 0.5f * (seen.min + seen.max) * b_;
  const Eigen::Vector3f moved = M_.leftCols<2>() * line.direction;
  line.stretch =
      (moved[axis_] * middle.z() - middle[axis_] * moved.z()) / (middle.z() * middle.z());
  return std::abs(line.stretch) > 0.4f && std::abs(line.stretch) < 2.5f;
}

// Samples the pattern: the reference around the pixel, with a step that corresponds to one sample
// of the line.
bool EpipolarSearch::TakePattern(const EdgePixel& pixel, const Line& line) {
  const Eigen::Vector2f step = line.direction / line.stretch;
  const Eigen::Vector2f centre(pixel.x, pixel.y);
  const Eigen::Vector2f reach = kHalf * step.cwiseAbs();
  if (centre.x() < reach.x() + 1 || centre.y() < reach.y() + 1 ||
      centre.x() + reach.x() >= static_cast<float>(width_ - 2) ||
      centre.y() + reach.y() >= static_cast<float>(height_ - 2))
    return false;
  const uint8_t* values = pair_.values.ptr<uint8_t>();
  const auto row = static_cast<std::ptrdiff_t>(pair_.values.step[0]);
  const int32_t step_x = ToFixed(step.x()), step_y = ToFixed(step.y());
  int32_t x = (pixel.x << kFixed) - kHalf * step_x, y = (pixel.y << kFixed) - kHalf * step_y;
  for (uint32_t& sample : pattern_) {
    sample = Sample(values, row, x, y);
    x += step_x;
    y += step_y;
  }
  return true;
}

// Samples the line from kMargin positions before the first to kMargin after the last: at whole
// pixels along the axis, interpolated across it.
void EpipolarSearch::WalkLine(int first, int places, float across, float slope) {
  const cv::Mat& values = pair_.other->values;
  const auto row = static_cast<std::ptrdiff_t>(values.step[0]);
  const std::ptrdiff_t along = axis_ == 0 ? 2 : row, beside = axis_ == 0 ? row : 2;
  const uint8_t* line = values.ptr<uint8_t>() + (first - kMargin) * along;
  int32_t position = ToFixed(across - static_cast<float>(kMargin) * slope);
  const int32_t step = ToFixed(slope);
  const int n = places + 2 * kMargin;
  for (int i = 0; i < n; ++i) {
    const uint8_t* p = line + (position >> kFixed) * beside;
    const uint32_t w = static_cast<uint32_t>(position & 0xffff) >> (kFixed - kShift);
    const uint32_t sum = Spread(p) * (kOne - w) + Spread(p + beside) * w;
    line_[i] = sum;
    line += along;
    position += step;
  }
}

// Position on the line with the smallest cost; kLanes are compared in parallel.
int EpipolarSearch::LeastCost(int places) {
  using cv::v_int32x4;
  std::array<cv::v_int16x8, kPattern> pattern;
  for (int k = 0; k < kPattern; ++k) {
    pattern[k] = cv::v_reinterpret_as_s16(cv::v_setall_u32(pattern_[k]));
  }
  v_int32x4 index(0, 1, 2, 3), best_index = index;
  v_int32x4 best = cv::v_setall_s32(INT32_MAX);
  const v_int32x4 step = cv::v_setall_s32(kLanes), end = cv::v_setall_s32(places);
  for (int t = 0; t < places; t += kLanes) {
    v_int32x4 cost = cv::v_setzero_s32();
    for (int k = 0; k < kPattern; ++k) {
      // The first position is at sample kMargin, and its pattern begins kHalf before it.
      const auto d =
          cv::v_reinterpret_as_s16(cv::v_load(&line_[t + k + kMargin - kHalf])) - pattern[k];
      cost = cost + cv::v_dotprod(d, d);
    }
    const v_int32x4 better = (cost < best) & (index < end);
    best = cv::v_select(better, cost, best);
    best_index = cv::v_select(better, index, best_index);
    index = index + step;
  }
  std::array<int32_t, kLanes> costs, places_of;
  cv::v_store(costs.data(), best);
  cv::v_store(places_of.data(), best_index);
  int least = 0;
  for (int lane = 1; lane < kLanes; ++lane) {
    const bool tie = costs[lane] == costs[least] && places_of[lane] < places_of[least];
    if (costs[lane] < costs[least] || tie) least = lane;
  }
  least_cost_ = costs[least];
  return places_of[least];
}

void EpipolarSearch::SearchInterval(const Line& line, const DepthInterval& interval,
                                    SearchCount& count, Match& match) {
  const DepthInterval seen = InFront(interval, line.a.z());
  if (seen.empty()) return;
  const Eigen::Vector3f far = line.a + seen.min * b_, near = line.a + seen.max * b_;
  const Eigen::Vector2f from = far.head<2>() / far.z(), to = near.head<2>() / near.z();
  const float u0 = from[axis_], u1 = to[axis_], v0 = from[1 - axis_], v1 = to[1 - axis_];
  const float extent = u1 - u0;
  // Beyond this, rounding errors could move the samples outside the image.
  constexpr float kFarthest = 1e4f;  // pixels
  const bool near_enough = std::abs(u0) < kFarthest && std::abs(u1) < kFarthest &&
                           std::abs(v0) < kFarthest && std::abs(v1) < kFarthest;
  if (!(near_enough && std::abs(extent) > 1e-3f)) return;
  const float slope = (v1 - v0) / extent;
  const int limit_u = axis_ == 0 ? width_ : height_, limit_v = axis_ == 0 ? height_ : width_;
  int first = std::max(static_cast<int>(std::floor(std::min(u0, u1))) - 1, kMargin);
  int last = std::min(static_cast<int>(std::ceil(std::max(u0, u1))) + 1, limit_u - 1 - kMargin);
  // Keep the line inside the image across the axis, too.
  const float low = 1, high = static_cast<float>(limit_v) - 3;
  if (std::abs(slope) > 1e-6f) {
    const float a = u0 + (low - v0) / slope, b = u0 + (high - v0) / slope;
    first = std::max(first, static_cast<int>(std::ceil(std::max(-1.0f, std::min(a, b)))) + kMargin);
    last = std::min(last, static_cast<int>(std::floor(std::min(1e4f, std::max(a, b)))) - kMargin);
  } else if (v0 < low || v0 > high) {
    return;
  }
  const int places = last - first + 1;
  if (places < 3 || places > kMaxPlaces) return;
  count.samples += places;
  const float across = v0 + (static_cast<float>(first) - u0) * slope;
  WalkLine(first, places, across, slope);

  const int best = LeastCost(places);
  if (best == 0 || best == places - 1) return;  // at the end of the interval: not a minimum
  if (match.cost >= 0 && match.cost <= least_cost_) return;
  match.cost = least_cost_;
  match.place = first + best;
  match.across = across + static_cast<float>(best) * slope;
  match.slope = slope;
  std::copy_n(&line_[best + kMargin - kHalf - 1], match.samples.size(), match.samples.begin());
}

// Sub-pixel position of the match, and the resulting inverse depth.
Hypothesis EpipolarSearch::Refine(const Line& line, const Match& match) const {
  // Gauss-Newton on the pattern (eq. 10).
  int32_t sum_gg = 0, sum_gr = 0;
  const auto add = [&](int before, int after, int here, int sought) {
    const int g = (after - before) / 2;
    sum_gg += g * g;
    sum_gr += g * (sought - here);
  };
  for (int k = 0; k < kPattern; ++k) {
    const uint32_t* s = &match.samples[k + 1];
    add(Intensity(s[-1]), Intensity(s[1]), Intensity(s[0]), Intensity(pattern_[k]));
    add(Gradient(s[-1]), Gradient(s[1]), Gradient(s[0]), Gradient(pattern_[k]));
  }
  if (sum_gg < 1) return {};
  const auto gradient2 = static_cast<float>(sum_gg), product = static_cast<float>(sum_gr);
  const float shift = product / gradient2;
  if (std::abs(shift) > 1) return {};
  const float residual2 = (static_cast<float>(match.cost) - product * shift) /
                          static_cast<float>(2 * kPattern * kOne * kOne);
  if (residual2 > static_cast<float>(settings_.max_residual * settings_.max_residual)) return {};
  const float u = static_cast<float>(match.place) + shift;
  const float v = match.across + shift * match.slope;

  // The gradient direction must agree, up to the relative rotation of the images.
  const int iu = static_cast<int>(u + 0.5f), iv = static_cast<int>(v + 0.5f);
  const int there = axis_ == 0 ? pair_.other->direction.at<uint8_t>(iv, iu)
                               : pair_.other->direction.at<uint8_t>(iu, iv);
  if (there == GradientImage::kUnusable) return {};
  int turned = (there - line.gradient_step - turn_) % GradientImage::kTurn;
  if (turned < 0) turned += GradientImage::kTurn;
  if (std::min(turned, GradientImage::kTurn - turned) > max_turn_) return {};

  // Eq. 8, and its derivative by the position along the axis.
  const float denominator = u * b_.z() - b_[axis_];
  const float numerator = line.a[axis_] - u * line.a.z();
  if (std::abs(denominator) < 1e-12f) return {};
  const float inverse_depth = numerator / denominator;
  if (!(inverse_depth > 0)) return {};
  const float by_place =
      (-line.a.z() * denominator - numerator * b_.z()) / (denominator * denominator);
  const float noise = static_cast<float>(settings_.intensity_sigma) * kOne;
  const float geometric = static_cast<float>(settings_.line_sigma) / line.cosine;
  const float sigma_place = std::sqrt(2 * noise * noise / gradient2 + geometric * geometric);
  return {inverse_depth, std::abs(by_place) * sigma_place};
}

}  // namespace alidade
