// The search of line_search.h for the lanes of a vector type V, as in line_geometry.h (Mur-Artal &
// Tardós, RSS 2015, §III-A). Uses nothing of the standard library: see cpu.h.
//
// Ints also hold samples: intensity in the low half, gradient in the high half, with kShift
// fractional bits.
#pragma once

#include <cstdint>

#include "alidade/semidense/simd/line_geometry.h"
#include "alidade/semidense/simd/line_search.h"

namespace alidade {

inline constexpr int kAround = kPattern + 2;  // samples of a match: one more on both sides
inline constexpr int kShift = 5, kOne = 1 << kShift;
inline constexpr int kHorizontalShift = 3;  // fractional bits of x in the pattern: sums fit 16 bits

template <class V>
class LineKernel {
 public:
  explicit LineKernel(const LinePair& pair) : pair_(pair), geometry_(pair) {}
  void Search(const LineQueries& queries, LineAnswers& answers);

 private:
  using Floats = typename V::Floats;
  using Ints = typename V::Ints;
  static constexpr int kLanes = V::kLanes;
  // Vectors of samples that kLanes positions are compared with.
  static constexpr int kBlocks = (kLineMargin + kHalf + kLanes + kLanes - 1) / kLanes;

  using Lines = typename LineGeometry<V>::Lines;
  using Parts = typename LineGeometry<V>::Parts;

  static Floats All(float x) { return V::All(x); }
  static Ints All(int x) { return V::All(x); }
  void TakePatterns(const LineQueries& queries, const Lines& lines);
  Ints Sample(const Parts& parts, bool rows, int lane, int first);
  void ForgetMatches();
  int LeastCost(const Parts& parts, bool rows, int lane, int& least);
  void SearchPart(const Parts& parts, bool rows, int lane);
  void Refine(const LineQueries& queries, const Lines& lines, LineAnswers& answers) const;
  bool Turned(int x, int y, int gradient_step) const;

  const LinePair& pair_;
  LineGeometry<V> geometry_;
  int patterns_[kPattern][kLanes];
  int line_[kMaxPlaces + (kBlocks + 1) * kLanes];  // samples
  // Best positions so far: cost, -1 if there is none yet; whole pixel along the axis; the line at
  // that position; the samples around.
  int cost_[kLanes], place_[kLanes];
  float across_[kLanes], slope_[kLanes];
  int around_[kAround][kLanes];
};

// Weights of two neighbors at a position between them, in 1/2^bits: of the first in the low half,
// of the second in the high half.
template <class V, int bits>
inline typename V::Ints WeightsAt(const typename V::Ints& position) {
  const auto second = V::template Right<kFixed - bits>(position & V::All(0xffff));
  return V::template Left<16>(second) - second + V::All(1 << bits);
}

// Weighted sums of two neighbors, given as the bytes intensity, gradient, intensity, gradient.
template <class V>
struct TwoSums {
  typename V::Ints intensity, gradient;
  TwoSums(const typename V::Ints& two, const typename V::Ints& weights) {
    const auto bytes = V::All(0x00ff00ff);
    intensity = V::Dot(two & bytes, weights);
    gradient = V::Dot(V::template Right<8>(two) & bytes, weights);
  }
};

// Low halves from `low`, high halves from `high`; both below 2^16.
template <class V>
inline typename V::Ints Joined(const typename V::Ints& low, const typename V::Ints& high) {
  return low | V::template Left<16>(high);
}

// Samples the reference around each pixel, with steps that correspond to one sample of the line.
// Lanes whose pattern is not in the image take it from pixel (0, 0).
template <class V>
void LineKernel<V>::TakePatterns(const LineQueries& queries, const Lines& lines) {
  const auto row = static_cast<int>(pair_.reference.row);
  const Ints inside = V::FromMask(lines.usable & ((1 << queries.count) - 1));
  const Ints x = V::Trunc(V::Load(queries.x)) & inside, y = V::Trunc(V::Load(queries.y)) & inside;
  const Ints step_x = lines.step_x & inside, step_y = lines.step_y & inside;
  const auto place = [&](const Ints& column, const Ints& line) {
    return line * All(row) + V::template Left<1>(column);
  };
  Ints xs = V::template Left<kFixed>(x) - V::template Left<1>(step_x);
  Ints ys = V::template Left<kFixed>(y) - V::template Left<1>(step_y);
  for (int k = 0; k < kPattern; ++k, xs = xs + step_x, ys = ys + step_y) {
    if (k == kHalf) continue;
    const Ints at = place(V::template Right<kFixed>(xs), V::template Right<kFixed>(ys));
    const Ints beside = WeightsAt<V, kHorizontalShift>(xs);
    const TwoSums<V> upper(V::Gather(pair_.reference.data, at), beside);
    const TwoSums<V> lower(V::Gather(pair_.reference.data + row, at), beside);
    const Ints below = WeightsAt<V, kShift>(ys);
    const auto between = [&](const Ints& above, const Ints& under) {
      return V::template Right<kHorizontalShift>(V::Dot(Joined<V>(above, under), below));
    };
    V::Store(patterns_[k], Joined<V>(between(upper.intensity, lower.intensity),
                                     between(upper.gradient, lower.gradient)));
  }
  const Ints centre = V::Gather(pair_.reference.data, place(x, y));
  const Ints byte = All(0xff);
  V::Store(patterns_[kHalf],
           V::template Left<kShift>(Joined<V>(centre & byte, V::template Right<8>(centre) & byte)));
}

template <class V>
void LineKernel<V>::ForgetMatches() {
  V::Store(cost_, All(-1));
  V::Store(place_, All(0));
  V::Store(across_, All(0.0f));
  V::Store(slope_, All(0.0f));
  for (auto& samples : around_) V::Store(samples, All(0));
}

// Samples the line at whole pixels along its axis, interpolated across it: those from `first` on,
// of which the first of all is kLineMargin positions before the first that is compared. Behind the
// last one of the line, it is repeated.
template <class V>
auto LineKernel<V>::Sample(const Parts& parts, bool rows, int lane, int first) -> Ints {
  const Plane& values = rows ? pair_.other : pair_.turned;
  const uint8_t* line = values.data + (parts.first[lane] - kLineMargin) * values.row;
  const Ints index = V::Min(V::Iota() + All(first), All(parts.places[lane] + 2 * kLineMargin - 1));
  const Ints x = All(parts.start[lane]) + index * All(parts.fixed_slope[lane]);
  const Ints aside = V::template Right<kFixed - 1>(x) & All(~1);  // two bytes a pixel
  const Ints two = V::Gather(line, index * All(static_cast<int>(values.row)) + aside);
  const TwoSums<V> sums(two, WeightsAt<V, kShift>(x));
  const Ints samples = Joined<V>(sums.intensity, sums.gradient);
  V::Store(&line_[first], samples);
  return samples;
}

// Position on the line with the smallest cost, the first of several; kLanes are compared at once.
template <class V>
int LineKernel<V>::LeastCost(const Parts& parts, bool rows, int lane, int& least) {
  Ints pattern[kPattern], samples[kBlocks];
  for (int k = 0; k < kPattern; ++k) pattern[k] = All(patterns_[k][lane]);
  for (int i = 0; i < kBlocks; ++i) samples[i] = Sample(parts, rows, lane, i * kLanes);
  Ints index = V::Iota(), best_index = index, best = All(INT32_MAX);
  const Ints step = All(kLanes), end = All(parts.places[lane]);
  for (int t = kLanes;; t += kLanes) {
    const auto squares = [&](int k, const Ints& from) {
      const Ints d = V::Minus16(from, pattern[k]);
      return V::Dot(d, d);
    };
    // The first position is at sample kLineMargin, and its pattern begins kHalf before it.
    static_assert(kLineMargin - kHalf == 1 && kPattern == 5);
    const Ints cost =
        squares(0, V::template From<1>(samples)) + squares(1, V::template From<2>(samples)) +
        squares(2, V::template From<3>(samples)) + squares(3, V::template From<4>(samples)) +
        squares(4, V::template From<5>(samples));
    const Ints better = (best > cost) & (end > index);
    best = V::Choose(better, cost, best);
    best_index = V::Choose(better, index, best_index);
    index = index + step;
    if (t >= parts.places[lane]) break;
    for (int i = 1; i < kBlocks; ++i) samples[i - 1] = samples[i];
    samples[kBlocks - 1] = Sample(parts, rows, lane, t + (kBlocks - 1) * kLanes);
  }
  least = V::LeastOf(best);
  return V::LeastOf(V::Choose(best == All(least), best_index, end));
}

template <class V>
void LineKernel<V>::SearchPart(const Parts& parts, bool rows, int lane) {
  int least;
  const int best = LeastCost(parts, rows, lane, least);
  // At the end of the interval: not a minimum.
  if (best == 0 || best == parts.places[lane] - 1) return;
  if (cost_[lane] >= 0 && cost_[lane] <= least) return;
  cost_[lane] = least;
  place_[lane] = parts.first[lane] + best;
  across_[lane] = parts.across[lane] + static_cast<float>(best) * parts.slope[lane];
  slope_[lane] = parts.slope[lane];
  const int at = place_[lane], beside = static_cast<int>(across_[lane]);
  const Plane& direction = pair_.direction;  // Turned() will look there
  __builtin_prefetch(direction.data + (rows ? at : beside) * direction.row + (rows ? beside : at));
  const int* from = &line_[best + kLineMargin - kHalf - 1];
  for (int i = 0; i < kAround; ++i) around_[i][lane] = from[i];
}

// True if the gradient direction differs by more than the images are turned, with some tolerance.
template <class V>
bool LineKernel<V>::Turned(int x, int y, int gradient_step) const {
  const int there = pair_.direction.data[y * pair_.direction.row + x];
  if (there >= kDirectionSteps) return true;
  int turned = there - gradient_step - pair_.turn;  // at most one and a half circles
  if (turned < 0) turned = -turned;
  if (turned >= kDirectionSteps) turned -= kDirectionSteps;
  return turned > pair_.max_turn && kDirectionSteps - turned > pair_.max_turn;
}

// Sub-pixel positions of the matches, and the resulting inverse depths.
template <class V>
void LineKernel<V>::Refine(const LineQueries& queries, const Lines& lines,
                           LineAnswers& answers) const {
  // Normal equation of a shift along the line (eq. 10): sum of squared derivatives, and sum of
  // derivatives times residuals.
  Ints squares = All(0), products = squares;
  for (int k = 0; k < kPattern; ++k) {
    const auto at = [&](int i) { return V::Load(around_[k + i]); };
    const Ints slope = V::Half16(V::Minus16(at(2), at(0)));
    squares = squares + V::Dot(slope, slope);
    products = products + V::Dot(slope, V::Minus16(V::Load(patterns_[k]), at(1)));
  }
  const Ints cost = V::Load(cost_);
  int found = V::Mask(V::AsMask((cost > All(-1)) & (squares > All(0))));
  if (found == 0) return;
  const Floats gradient2 = V::ToFloats(squares), product = V::ToFloats(products);
  const Floats shift = product / gradient2;
  const Floats residual2 =
      (V::ToFloats(cost) - product * shift) / All(static_cast<float>(2 * kPattern * kOne * kOne));
  const Floats u = V::ToFloats(V::Load(place_)) + shift;
  const Floats v = V::Load(across_) + shift * V::Load(slope_);

  // Eq. 8, and its derivative by the position along the axis.
  const float* b = pair_.shift;
  const Floats b_z = All(b[2]);
  const Floats denominator = u * b_z - V::Choose(lines.rows, All(b[1]), All(b[0]));
  const Floats numerator = V::Choose(lines.rows, lines.a_y, lines.a_x) - u * lines.a_z;
  const Floats inverse_depth = numerator / denominator;
  const Floats zero = All(0.0f);
  const Floats by_place =
      ((zero - lines.a_z) * denominator - numerator * b_z) / (denominator * denominator);
  const float noise = pair_.noise * kOne;
  const Floats geometric = All(pair_.line_sigma) / lines.cosine;
  const Floats sigma_place = V::Sqrt(All(2 * noise * noise) / gradient2 + geometric * geometric);
  found &= V::Mask((V::Abs(shift) <= All(1.0f)) & (residual2 <= All(pair_.max_residual2)) &
                   (V::Abs(denominator) >= All(1e-12f)) & (inverse_depth > zero));

  const int rows = V::Mask(lines.rows);
  const Floats half = All(0.5f);
  int along[kLanes], across[kLanes];
  float depths[kLanes], sigmas[kLanes];
  V::Store(along, V::Trunc(u + half));
  V::Store(across, V::Trunc(v + half));
  V::Store(depths, inverse_depth);
  V::Store(sigmas, V::Abs(by_place) * sigma_place);
  for (; found != 0; found &= found - 1) {
    const int lane = __builtin_ctz(static_cast<unsigned>(found));
    const bool row = rows >> lane & 1;
    const int x = row ? across[lane] : along[lane], y = row ? along[lane] : across[lane];
    if (Turned(x, y, queries.gradient_step[lane])) continue;
    answers.inverse_depth[lane] = depths[lane];
    answers.sigma[lane] = sigmas[lane];
  }
}

template <class V>
void LineKernel<V>::Search(const LineQueries& queries, LineAnswers& answers) {
  answers = {};
  const Lines lines = geometry_.LinesOf(queries);
  const int usable = lines.usable & ((1 << queries.count) - 1);
  if (usable == 0) return;
  answers.searches = __builtin_popcount(static_cast<unsigned>(usable));
  const int rows = V::Mask(lines.rows);
  TakePatterns(queries, lines);
  ForgetMatches();
  for (int i = 0; i < queries.intervals; ++i) {
    const Parts parts = geometry_.PartsOf(lines, V::Load(queries.min[i]), V::Load(queries.max[i]));
    for (int left = usable & parts.usable; left != 0; left &= left - 1) {
      const int lane = __builtin_ctz(static_cast<unsigned>(left));
      answers.samples += parts.places[lane];
      SearchPart(parts, rows >> lane & 1, lane);
    }
  }
  Refine(queries, lines, answers);
}

}  // namespace alidade
