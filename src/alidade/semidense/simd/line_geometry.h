// Where epipolar lines run, and which part of them an interval of depth covers, for the lanes of a
// vector type. Uses nothing of the standard library: see cpu.h.
//
// V: Floats and Ints with operators, kLanes of them, and functions on them.
#pragma once

#include <cstdint>

#include "alidade/semidense/simd/line_search.h"

namespace alidade {

// The pattern that is compared: 2 kHalf + 1 samples, on the line and around the pixel.
inline constexpr int kHalf = 2, kPattern = 2 * kHalf + 1;
inline constexpr int kLineMargin = kHalf + 1;  // samples needed beyond the compared positions
inline constexpr int kMaxPlaces = 256;         // positions compared per interval, at most
inline constexpr int kFixed = 16;              // fractional bits of positions
// Smallest ratio of the depth in the other camera to the depth in the reference.
inline constexpr float kInFront = 0.1f;
// Beyond this, rounding errors could move the samples outside the image.
inline constexpr float kFarthest = 1e4f;  // pixels

template <class V>
class LineGeometry {
 public:
  using Floats = typename V::Floats;
  using Ints = typename V::Ints;
  static constexpr int kLanes = V::kLanes;

  struct Lines {
    // Pixel in the other image = a + inverse depth * shift, homogeneous.
    Floats a_x, a_y, a_z;
    Floats rows;    // mask: positions are counted along rows (y), else along columns (x)
    Floats cosine;  // of the angle between line and gradient
    // Distance of two samples of the pattern in the reference: as far as two samples of the line
    // are apart in the other image. Pixels with kFixed fractional bits.
    Ints step_x, step_y;
    int usable;  // bit per lane: depth is observable along the line, the pattern is in the image
  };
  // Part of each line, counted in whole pixels along its axis.
  struct Parts {
    int first[kLanes], places[kLanes];       // positions to compare
    float across[kLanes], slope[kLanes];     // position across the axis at the first; its change
    int start[kLanes], fixed_slope[kLanes];  // kLineMargin before the first, fixed-point
    int usable;                              // bit per lane: there is something to compare
  };

  explicit LineGeometry(const LinePair& pair) : pair_(pair) {}
  Lines LinesOf(const LineQueries& queries) const;
  Parts PartsOf(const Lines& lines, const Floats& min, const Floats& max) const;

 private:
  struct Interval {
    Floats min, max;
  };
  struct Ends {  // of an interval on the line
    Floats from_x, from_y, to_x, to_y;
  };
  static Floats All(float x) { return V::All(x); }
  static Ints All(int x) { return V::All(x); }
  static Ints ToFixed(const Floats& x) {
    return V::Trunc(x * All(static_cast<float>(1 << kFixed)));
  }
  static Floats Norm(const Floats& x, const Floats& y) { return V::Sqrt(x * x + y * y); }

  Interval InFront(const Floats& min, const Floats& max, const Floats& a_z) const;
  Ends EndsOf(const Lines& lines, const Interval& seen) const;
  Floats Stretch(const Lines& lines, const Interval& seen, const Floats& direction_x,
                 const Floats& direction_y) const;

  const LinePair& pair_;
};

// Part of the interval in front of the other camera. `a_z`: Lines::a_z.
template <class V>
auto LineGeometry<V>::InFront(const Floats& min, const Floats& max, const Floats& a_z) const
    -> Interval {
  const float z = pair_.shift[2];
  if (-1e-6f < z && z < 1e-6f) {
    const Floats behind = a_z < All(kInFront);
    return {min, V::Choose(behind, min, max)};  // empty behind the camera
  }
  const Floats limit = (All(kInFront) - a_z) / All(z);
  if (z < 0) return {min, V::Min(max, limit)};
  return {V::Max(min, limit), max};
}

template <class V>
auto LineGeometry<V>::EndsOf(const Lines& lines, const Interval& seen) const -> Ends {
  const Floats b_x = All(pair_.shift[0]), b_y = All(pair_.shift[1]), b_z = All(pair_.shift[2]);
  const Floats far_z = lines.a_z + seen.min * b_z, near_z = lines.a_z + seen.max * b_z;
  return {(lines.a_x + seen.min * b_x) / far_z, (lines.a_y + seen.min * b_y) / far_z,
          (lines.a_x + seen.max * b_x) / near_z, (lines.a_y + seen.max * b_y) / near_z};
}

// Pixels along the line in the other image per pixel in the reference, at a medium depth.
template <class V>
auto LineGeometry<V>::Stretch(const Lines& lines, const Interval& seen, const Floats& direction_x,
                              const Floats& direction_y) const -> Floats {
  const auto& M = pair_.at_infinity;
  const Floats middle = All(0.5f) * (seen.min + seen.max);
  const auto at = [&](const Floats& a, int i) { return a + middle * All(pair_.shift[i]); };
  const auto moved = [&](int i) { return All(M[i][0]) * direction_x + All(M[i][1]) * direction_y; };
  const Floats along = V::Choose(lines.rows, at(lines.a_y, 1), at(lines.a_x, 0));
  const Floats z = at(lines.a_z, 2);
  return (V::Choose(lines.rows, moved(1), moved(0)) * z - along * moved(2)) / (z * z);
}

template <class V>
auto LineGeometry<V>::LinesOf(const LineQueries& queries) const -> Lines {
  const Floats x = V::Load(queries.x), y = V::Load(queries.y);
  Floats direction_x = All(pair_.epipole[0]) - All(pair_.epipole[2]) * x;
  Floats direction_y = All(pair_.epipole[1]) - All(pair_.epipole[2]) * y;
  const Floats length = Norm(direction_x, direction_y);
  direction_x = direction_x / length;
  direction_y = direction_y / length;

  Lines lines;
  lines.cosine =
      V::Abs(V::Load(queries.gradient_x) * direction_x + V::Load(queries.gradient_y) * direction_y);
  const auto& M = pair_.at_infinity;
  const auto at_infinity = [&](int i) {
    return All(M[i][0]) * x + (All(M[i][1]) * y + All(M[i][2]));
  };
  lines.a_x = at_infinity(0);
  lines.a_y = at_infinity(1);
  lines.a_z = at_infinity(2);
  const Interval seen = InFront(V::Load(queries.lowest), V::Load(queries.highest), lines.a_z);
  const Ends ends = EndsOf(lines, seen);
  lines.rows = V::Abs(ends.to_x - ends.from_x) < V::Abs(ends.to_y - ends.from_y);

  const Floats stretch = Stretch(lines, seen, direction_x, direction_y);
  const Floats step_x = direction_x / stretch, step_y = direction_y / stretch;
  const Floats half = All(static_cast<float>(kHalf)), one = All(1.0f);
  const Floats reach_x = half * V::Abs(step_x), reach_y = half * V::Abs(step_y);
  const Floats fits = (x >= reach_x + one) & (y >= reach_y + one) &
                      (x + reach_x < All(static_cast<float>(pair_.width - 2))) &
                      (y + reach_y < All(static_cast<float>(pair_.height - 2)));
  lines.usable = V::Mask((length > All(1e-9f)) & (lines.cosine >= All(pair_.least_cosine)) &
                         (seen.min < seen.max) & (V::Abs(stretch) > All(0.4f)) &
                         (V::Abs(stretch) < All(2.5f)) & fits);
  lines.step_x = ToFixed(step_x);
  lines.step_y = ToFixed(step_y);
  return lines;
}

template <class V>
auto LineGeometry<V>::PartsOf(const Lines& lines, const Floats& min, const Floats& max) const
    -> Parts {
  const auto choose = [&](const auto& a, const auto& b) { return V::Choose(lines.rows, a, b); };
  const Interval seen = InFront(min, max, lines.a_z);
  const Ends ends = EndsOf(lines, seen);
  const Floats u0 = choose(ends.from_y, ends.from_x), u1 = choose(ends.to_y, ends.to_x);
  const Floats v0 = choose(ends.from_x, ends.from_y), v1 = choose(ends.to_x, ends.to_y);
  const Floats extent = u1 - u0, farthest = All(kFarthest);
  const Floats near_enough = (V::Abs(u0) < farthest) & (V::Abs(u1) < farthest) &
                             (V::Abs(v0) < farthest) & (V::Abs(v1) < farthest);
  const Floats slope = (v1 - v0) / extent;
  const Ints one = All(1), margin = All(kLineMargin);
  const Ints limit = choose(All(pair_.height), All(pair_.width));
  Ints first = V::Max(V::Floor(V::Min(u0, u1)) - one, margin);
  Ints last = V::Min(V::Ceil(V::Max(u0, u1)) + one, limit - one - margin);
  // Keep the line inside the image across the axis, too.
  const Floats low = All(1.0f);
  const Floats high =
      choose(All(static_cast<float>(pair_.width - 3)), All(static_cast<float>(pair_.height - 3)));
  const Floats steep = V::Abs(slope) > All(1e-6f);
  const Floats a = u0 + (low - v0) / slope, b = u0 + (high - v0) / slope;
  const Ints enters = V::Ceil(V::Max(All(-1.0f), V::Min(a, b))) + margin;
  const Ints leaves = V::Floor(V::Min(farthest, V::Max(a, b))) - margin;
  first = V::Choose(steep, V::Max(first, enters), first);
  last = V::Choose(steep, V::Min(last, leaves), last);
  const Ints places = last - first + one;
  const Floats across = v0 + (V::ToFloats(first) - u0) * slope;

  Parts parts;
  const Floats many = V::AsMask((places > All(2)) & (All(kMaxPlaces + 1) > places));
  parts.usable = V::Mask((seen.min < seen.max) & near_enough & (V::Abs(extent) > All(1e-3f)) &
                         (steep | ((v0 >= low) & (v0 <= high))) & many);
  V::Store(parts.first, first);
  V::Store(parts.places, places);
  V::Store(parts.across, across);
  V::Store(parts.slope, slope);
  V::Store(parts.start, ToFixed(across - All(static_cast<float>(kLineMargin)) * slope));
  V::Store(parts.fixed_slope, ToFixed(slope));
  return parts;
}

}  // namespace alidade
