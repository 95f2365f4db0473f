#include "alidade/semidense/epipolar_search.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace alidade {
namespace {

using cv::v_uint32x4;

constexpr int kShift = 5;  // fractional bits of samples
constexpr int kOne = 1 << kShift;
constexpr int kHorizontalShift = 3;  // fractional bits of x in the pattern: sums fit in 16 bits

// Two neighbouring pixels of GradientImage::values: intensity and gradient of each, a byte each.
inline uint32_t Two(const uint8_t* pixel) {
  uint32_t two;
  std::memcpy(&two, pixel, sizeof(two));
  return two;
}

// Weights of two neighbours at a position between them, in 1/2^bits: of the first in the low half,
// of the second in the high half.
template <int bits>
inline cv::v_int16x8 WeightsAt(const Ints& position) {
  const Ints second = cv::v_shr<kFixed - bits>(position & All(0xffff));
  return cv::v_reinterpret_as_s16(cv::v_shl<16>(second) - second + All(1 << bits));
}

inline cv::v_int16x8 Pairs(const v_uint32x4& values) { return cv::v_reinterpret_as_s16(values); }

// Weighted sums of the two pixels of each lane.
struct Sums {
  Ints intensity, gradient;
  Sums(const v_uint32x4& two, const cv::v_int16x8& weights) {
    const v_uint32x4 bytes = cv::v_setall_u32(0x00ff00ff);
    intensity = cv::v_dotprod(Pairs(two & bytes), weights);
    gradient = cv::v_dotprod(Pairs(cv::v_shr<8>(two) & bytes), weights);
  }
};

// Low halves from `low`, high halves from `high`; both below 2^16.
inline v_uint32x4 Joined(const Ints& low, const Ints& high) {
  return cv::v_reinterpret_as_u32(low | cv::v_shl<16>(high));
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

EpipolarPair::EpipolarPair(const GradientImage& reference_image, const GradientImage& other_image,
                           cv::Mat reference_values, const Se3& T)
    : reference(&reference_image),
      other(&other_image),
      values(std::move(reference_values)),
      T_other_reference(T) {
  cv::transpose(other->values, other_turned);
}

EpipolarSearch::EpipolarSearch(const EpipolarPair& pair, const Camera& camera,
                               const SemiDenseSettings& settings)
    : pair_(pair),
      settings_(settings),
      geometry_(camera, pair.T_other_reference, settings.max_edge_angle) {
  const Eigen::Matrix3d& R = pair.T_other_reference.R;
  const double turn = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
  turn_ = static_cast<int>(std::lround(turn / (2 * CV_PI) * GradientImage::kTurn));
  max_turn_ = static_cast<int>(settings.max_turn / 360 * GradientImage::kTurn);
}

Lanes<Hypothesis> EpipolarSearch::Search(std::span<const EpipolarQuery> queries,
                                         SearchCount& count) {
  const Directions& directions = AllDirections();
  EdgeLanes edges;
  Lanes<int> gradient_step;
  size_t most_intervals = 0;
  for (size_t lane = 0; lane < kLanes; ++lane) {
    // Lanes to spare repeat the last pixel.
    const auto& [pixel, intervals] = queries[std::min(lane, queries.size() - 1)];
    edges.x[lane] = pixel.x;
    edges.y[lane] = pixel.y;
    gradient_step[lane] = pair_.reference->direction.at<uint8_t>(pixel.y, pixel.x);
    edges.gradient_x[lane] = directions.x[gradient_step[lane]];
    edges.gradient_y[lane] = directions.y[gradient_step[lane]];
    edges.min[lane] = intervals[0].min;
    edges.max[lane] = intervals[0].max;
    for (const DepthInterval& interval : intervals.subspan(1)) {
      edges.min[lane] = std::min(edges.min[lane], interval.min);
      edges.max[lane] = std::max(edges.max[lane], interval.max);
    }
    most_intervals = std::max(most_intervals, intervals.size());
  }
  const EpipolarLines lines = geometry_.Lines(edges);
  const int usable = lines.usable & ((1 << queries.size()) - 1);
  if (usable == 0) return {};
  const int rows = cv::v_signmask(lines.rows);
  for (int lane = 0; lane < kLanes; ++lane) {
    if ((usable >> lane & 1) == 0) continue;
    ++count.searches;
    TakePattern(queries[lane].pixel, lines, lane);
  }
  Matches matches;
  for (size_t i = 0; i < most_intervals; ++i) {
    for (size_t lane = 0; lane < queries.size(); ++lane) {
      const std::span<const DepthInterval> intervals = queries[lane].intervals;
      const DepthInterval interval = i < intervals.size() ? intervals[i] : DepthInterval{};
      edges.min[lane] = interval.min;
      edges.max[lane] = interval.max;
    }
    const LineParts parts =
        geometry_.Parts(lines, cv::v_load(edges.min.data()), cv::v_load(edges.max.data()));
    for (int lane = 0; lane < kLanes; ++lane) {
      if ((usable & parts.usable) >> lane & 1) {
        count.samples += parts.places[lane];
        SearchPart(parts, rows >> lane & 1, lane, matches);
      }
    }
  }
  return Refine(lines, matches, gradient_step);
}

// Samples the reference around the pixel, with a step that corresponds to one sample of the line.
void EpipolarSearch::TakePattern(const EdgePixel& pixel, const EpipolarLines& lines, int lane) {
  const uint8_t* values = pair_.values.ptr<uint8_t>();
  const auto row = static_cast<std::ptrdiff_t>(pair_.values.step[0]);
  const int32_t step_x = lines.step_x[lane], step_y = lines.step_y[lane];
  const int32_t x = pixel.x << kFixed, y = pixel.y << kFixed;
  const Lanes<int32_t> xs{x - 2 * step_x, x - step_x, x + step_x, x + 2 * step_x};
  const Lanes<int32_t> ys{y - 2 * step_y, y - step_y, y + step_y, y + 2 * step_y};
  const auto at = [&](int i) { return values + (ys[i] >> kFixed) * row + 2 * (xs[i] >> kFixed); };
  const uint8_t *a = at(0), *b = at(1), *c = at(2), *d = at(3);
  const cv::v_int16x8 beside = WeightsAt<kHorizontalShift>(cv::v_load(xs.data()));
  const cv::v_int16x8 below = WeightsAt<kShift>(cv::v_load(ys.data()));
  const Sums upper(v_uint32x4(Two(a), Two(b), Two(c), Two(d)), beside);
  const Sums lower(v_uint32x4(Two(a + row), Two(b + row), Two(c + row), Two(d + row)), beside);
  const auto between = [&](const Ints& above, const Ints& under) {
    return cv::v_shr<kHorizontalShift>(cv::v_dotprod(Pairs(Joined(above, under)), below));
  };
  Lanes<uint32_t> around;
  cv::v_store(around.data(), Joined(between(upper.intensity, lower.intensity),
                                    between(upper.gradient, lower.gradient)));
  const uint8_t* centre = values + pixel.y * row + 2 * pixel.x;
  const uint32_t exactly = kOne * (centre[0] | static_cast<uint32_t>(centre[1]) << 16);
  static_assert(kHalf == 2);
  patterns_[lane] = {around[0], around[1], exactly, around[2], around[3], 0, 0, 0};
}

// Samples the line from kLineMargin positions before the first to kLineMargin after the last: at
// whole pixels along the axis, interpolated across it.
void EpipolarSearch::WalkLine(const LineParts& parts, bool rows, int lane) {
  const cv::Mat& values = rows ? pair_.other->values : pair_.other_turned;
  const auto along = static_cast<std::ptrdiff_t>(values.step[0]);
  const uint8_t* line = values.ptr<uint8_t>() + (parts.first[lane] - kLineMargin) * along;
  const int64_t step = parts.fixed_slope[lane], start = parts.fixed_across[lane];
  const auto slope = static_cast<int32_t>(step);
  const Ints steps(0, slope, 2 * slope, 3 * slope);
  const int last = parts.places[lane] + 2 * kLineMargin - kLanes;
  for (int first = 0;; first = std::min(first + kLanes, last)) {  // the last two blocks may overlap
    const uint8_t* p = line + first * along;
    const int64_t x = start + first * step;
    const auto two = [&](int k) { return Two(p + k * along + 2 * ((x + k * step) >> kFixed)); };
    const Sums sums(v_uint32x4(two(0), two(1), two(2), two(3)),
                    WeightsAt<kShift>(All(static_cast<int>(x)) + steps));
    cv::v_store(&line_[first], Joined(sums.intensity, sums.gradient));
    if (first == last) break;
  }
}

// Position on the line with the smallest cost, the first of several; kLanes are compared at once.
int EpipolarSearch::LeastCost(int lane, int places) {
  std::array<cv::v_int16x8, kPattern> pattern;
  for (int k = 0; k < kPattern; ++k) pattern[k] = Pairs(cv::v_setall_u32(patterns_[lane][k]));
  Ints index(0, 1, 2, 3), best_index = index, best = All(INT32_MAX);
  const Ints step = All(kLanes), end = All(places);
  for (int t = 0; t < places; t += kLanes) {
    Ints cost = cv::v_setzero_s32();
    for (int k = 0; k < kPattern; ++k) {
      // The first position is at sample kLineMargin, and its pattern begins kHalf before it.
      const auto d = Pairs(cv::v_load(&line_[t + k + kLineMargin - kHalf])) - pattern[k];
      cost = cost + cv::v_dotprod(d, d);
    }
    const Ints better = (cost < best) & (index < end);
    best = cv::v_select(better, cost, best);
    best_index = cv::v_select(better, index, best_index);
    index = index + step;
  }
  least_cost_ = cv::v_reduce_min(best);
  return cv::v_reduce_min(cv::v_select(best == All(least_cost_), best_index, end));
}

void EpipolarSearch::SearchPart(const LineParts& parts, bool rows, int lane, Matches& matches) {
  WalkLine(parts, rows, lane);
  const int best = LeastCost(lane, parts.places[lane]);
  // At the end of the interval: not a minimum.
  if (best == 0 || best == parts.places[lane] - 1) return;
  if (matches.cost[lane] >= 0 && matches.cost[lane] <= least_cost_) return;
  matches.cost[lane] = least_cost_;
  matches.place[lane] = parts.first[lane] + best;
  matches.across[lane] = parts.across[lane] + static_cast<float>(best) * parts.slope[lane];
  matches.slope[lane] = parts.slope[lane];
  const int at = matches.place[lane], beside = static_cast<int>(matches.across[lane]);
  // Turned() will look there.
  __builtin_prefetch(rows ? pair_.other->direction.ptr(at, beside)
                          : pair_.other->direction.ptr(beside, at));
  const uint32_t* from = &line_[best + kLineMargin - kHalf - 1];
  for (int i = 0; i < kAround; i += kLanes)
    cv::v_store(&matches.samples[lane][i], cv::v_load(from + i));
}

// Normal equation of a shift along the line (eq. 10): sum of squared derivatives, and sum of
// derivatives times residuals. Returns false if the line is flat there.
bool EpipolarSearch::SumsOf(const Matches& matches, int lane, int32_t& gradient2,
                            int32_t& product) const {
  Ints squares = cv::v_setzero_s32(), products = squares;
  const uint32_t* samples = matches.samples[lane].data();
  for (int k = 0; k < kPattern; k += kLanes) {
    const auto at = [&](int i) { return Pairs(cv::v_load(samples + k + i)); };
    const auto pattern = Pairs(cv::v_load(&patterns_[lane][k]));
    const auto twice = at(2) - at(0);
    // Half of it, rounded towards zero.
    const auto negative = cv::v_reinterpret_as_s16(cv::v_shr<15>(cv::v_reinterpret_as_u16(twice)));
    auto slope = cv::v_shr<1>(twice + negative);
    // Only the first lane of the second round is of the pattern.
    if (k > 0) slope = slope & cv::v_reinterpret_as_s16(Ints(-1, 0, 0, 0));
    squares = squares + cv::v_dotprod(slope, slope);
    products = products + cv::v_dotprod(slope, pattern - at(1));
  }
  gradient2 = cv::v_reduce_sum(squares);
  product = cv::v_reduce_sum(products);
  return gradient2 > 0;
}

// True if the gradient direction differs by more than the images are turned, with some tolerance.
bool EpipolarSearch::Turned(const cv::Mat& direction, int x, int y, int gradient_step) const {
  const int there = direction.at<uint8_t>(y, x);
  if (there == GradientImage::kUnusable) return true;
  int turned = (there - gradient_step - turn_) % GradientImage::kTurn;
  if (turned < 0) turned += GradientImage::kTurn;
  return std::min(turned, GradientImage::kTurn - turned) > max_turn_;
}

// Sub-pixel positions of the matches, and the resulting inverse depths.
Lanes<Hypothesis> EpipolarSearch::Refine(const EpipolarLines& lines, const Matches& matches,
                                         const Lanes<int>& gradient_step) const {
  Lanes<int32_t> sum_gg{1, 1, 1, 1}, sum_gr{};
  int found = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (matches.cost[lane] >= 0 && SumsOf(matches, lane, sum_gg[lane], sum_gr[lane]))
      found |= 1 << lane;
  }
  if (found == 0) return {};
  const auto floats = [](const Lanes<int32_t>& ints) {
    return cv::v_cvt_f32(cv::v_load(ints.data()));
  };
  const Floats gradient2 = floats(sum_gg), product = floats(sum_gr);
  const Floats shift = product / gradient2;
  const Floats residual2 = (floats(matches.cost) - product * shift) /
                           All(static_cast<float>(2 * kPattern * kOne * kOne));
  const Floats u = floats(matches.place) + shift;
  const Floats v = cv::v_load(matches.across.data()) + shift * cv::v_load(matches.slope.data());

  // Eq. 8, and its derivative by the position along the axis.
  const Eigen::Vector3f& b = geometry_.shift();
  const Floats b_z = All(b.z());
  const Floats denominator = u * b_z - Choose(lines.rows, All(b.y()), All(b.x()));
  const Floats numerator = Choose(lines.rows, lines.a_y, lines.a_x) - u * lines.a_z;
  const Floats inverse_depth = numerator / denominator;
  const Floats zero = All(0.0f);
  const Floats by_place =
      ((zero - lines.a_z) * denominator - numerator * b_z) / (denominator * denominator);
  const float noise = static_cast<float>(settings_.intensity_sigma) * kOne;
  const Floats geometric = All(static_cast<float>(settings_.line_sigma)) / lines.cosine;
  const Floats sigma_place = cv::v_sqrt(All(2 * noise * noise) / gradient2 + geometric * geometric);
  const auto most = static_cast<float>(settings_.max_residual * settings_.max_residual);
  found &= cv::v_signmask((cv::v_abs(shift) <= All(1.0f)) & (residual2 <= All(most)) &
                          (cv::v_abs(denominator) >= All(1e-12f)) & (inverse_depth > zero));

  const int rows = cv::v_signmask(lines.rows);
  const Floats half = All(0.5f);
  Lanes<int32_t> along, across;
  Lanes<float> depths, sigmas;
  cv::v_store(along.data(), cv::v_trunc(u + half));
  cv::v_store(across.data(), cv::v_trunc(v + half));
  cv::v_store(depths.data(), inverse_depth);
  cv::v_store(sigmas.data(), cv::v_abs(by_place) * sigma_place);
  Lanes<Hypothesis> result;
  for (int lane = 0; lane < kLanes; ++lane) {
    if ((found >> lane & 1) == 0) continue;
    int x = along[lane], y = across[lane];
    if (rows >> lane & 1) std::swap(x, y);
    if (!Turned(pair_.other->direction, x, y, gradient_step[lane]))
      result[lane] = {depths[lane], sigmas[lane]};
  }
  return result;
}

}  // namespace alidade
