#include "alidade/semidense/epipolar_lines.h"

#include <cmath>

#include "alidade/semidense/pixel_transfer.h"

namespace alidade {
namespace {

// Smallest ratio of the depth in the other camera to the depth in the reference.
constexpr float kInFront = 0.1f;
// Beyond this, rounding errors could move the samples outside the image.
constexpr float kFarthest = 1e4f;  // pixels

template <typename T>
auto Load(const Lanes<T>& lanes) {
  return cv::v_load(lanes.data());
}

template <typename T, typename V>
void Store(Lanes<T>& lanes, const V& values) {
  cv::v_store(lanes.data(), values);
}

Ints Choose(const Floats& mask, const Ints& a, const Ints& b) {
  return cv::v_select(cv::v_reinterpret_as_s32(mask), a, b);
}

Floats AsMask(const Ints& mask) { return cv::v_reinterpret_as_f32(mask); }

Floats Norm(const Floats& x, const Floats& y) { return cv::v_sqrt(x * x + y * y); }

}  // namespace

EpipolarGeometry::EpipolarGeometry(const Camera& camera, const Se3& T_other_reference,
                                   double max_edge_angle)
    : least_cosine_(static_cast<float>(std::cos(max_edge_angle * CV_PI / 180))),
      width_(camera.width),
      height_(camera.height) {
  const PixelTransfer to_other(camera, T_other_reference);
  at_infinity_ = to_other.at_infinity;
  shift_ = to_other.shift;
  epipole_ = PixelTransfer(camera, T_other_reference.Inverse()).shift;
}

// Part of the interval in front of the other camera. `a_z`: EpipolarLines::a_z.
EpipolarGeometry::Interval EpipolarGeometry::InFront(const Floats& min, const Floats& max,
                                                     const Floats& a_z) const {
  if (std::abs(shift_.z()) < 1e-6f) {
    const Floats behind = a_z < All(kInFront);
    return {min, Choose(behind, min, max)};  // empty behind the camera
  }
  const Floats limit = (All(kInFront) - a_z) / All(shift_.z());
  if (shift_.z() < 0) return {min, cv::v_min(max, limit)};
  return {cv::v_max(min, limit), max};
}

EpipolarGeometry::Ends EpipolarGeometry::EndsOf(const EpipolarLines& lines,
                                                const Interval& seen) const {
  const Floats b_x = All(shift_.x()), b_y = All(shift_.y()), b_z = All(shift_.z());
  const Floats far_z = lines.a_z + seen.min * b_z, near_z = lines.a_z + seen.max * b_z;
  return {(lines.a_x + seen.min * b_x) / far_z, (lines.a_y + seen.min * b_y) / far_z,
          (lines.a_x + seen.max * b_x) / near_z, (lines.a_y + seen.max * b_y) / near_z};
}

// Pixels along the line in the other image per pixel in the reference, at a medium depth.
Floats EpipolarGeometry::Stretch(const EpipolarLines& lines, const Interval& seen,
                                 const Floats& direction_x, const Floats& direction_y) const {
  const Eigen::Matrix3f& M = at_infinity_;
  const Floats middle = All(0.5f) * (seen.min + seen.max);
  const auto at = [&](const Floats& a, int i) { return a + middle * All(shift_[i]); };
  const auto moved = [&](int i) { return All(M(i, 0)) * direction_x + All(M(i, 1)) * direction_y; };
  const Floats along = Choose(lines.rows, at(lines.a_y, 1), at(lines.a_x, 0));
  const Floats z = at(lines.a_z, 2);
  return (Choose(lines.rows, moved(1), moved(0)) * z - along * moved(2)) / (z * z);
}

EpipolarLines EpipolarGeometry::Lines(const EdgeLanes& edges) const {
  const Floats x = Load(edges.x), y = Load(edges.y);
  Floats direction_x = All(epipole_.x()) - All(epipole_.z()) * x;
  Floats direction_y = All(epipole_.y()) - All(epipole_.z()) * y;
  const Floats length = Norm(direction_x, direction_y);
  direction_x = direction_x / length;
  direction_y = direction_y / length;

  EpipolarLines lines;
  lines.cosine =
      cv::v_abs(Load(edges.gradient_x) * direction_x + Load(edges.gradient_y) * direction_y);
  const Eigen::Matrix3f& M = at_infinity_;
  const auto at_infinity = [&](int i) {
    return All(M(i, 0)) * x + (All(M(i, 1)) * y + All(M(i, 2)));
  };
  lines.a_x = at_infinity(0);
  lines.a_y = at_infinity(1);
  lines.a_z = at_infinity(2);
  const Interval seen = InFront(Load(edges.min), Load(edges.max), lines.a_z);
  const Ends ends = EndsOf(lines, seen);
  lines.rows = cv::v_abs(ends.to_x - ends.from_x) < cv::v_abs(ends.to_y - ends.from_y);

  const Floats stretch = Stretch(lines, seen, direction_x, direction_y);
  const Floats step_x = direction_x / stretch, step_y = direction_y / stretch;
  const Floats half = All(static_cast<float>(kHalf)), one = All(1.0f);
  const Floats reach_x = half * cv::v_abs(step_x), reach_y = half * cv::v_abs(step_y);
  const Floats fits = (x >= reach_x + one) & (y >= reach_y + one) &
                      (x + reach_x < All(static_cast<float>(width_ - 2))) &
                      (y + reach_y < All(static_cast<float>(height_ - 2)));
  lines.usable = cv::v_signmask((length > All(1e-9f)) & (lines.cosine >= All(least_cosine_)) &
                                (seen.min < seen.max) & (cv::v_abs(stretch) > All(0.4f)) &
                                (cv::v_abs(stretch) < All(2.5f)) & fits);
  Store(lines.step_x, ToFixed(step_x));
  Store(lines.step_y, ToFixed(step_y));
  return lines;
}

LineParts EpipolarGeometry::Parts(const EpipolarLines& lines, const Floats& min,
                                  const Floats& max) const {
  const Interval seen = InFront(min, max, lines.a_z);
  const Ends ends = EndsOf(lines, seen);
  const Floats u0 = Choose(lines.rows, ends.from_y, ends.from_x);
  const Floats u1 = Choose(lines.rows, ends.to_y, ends.to_x);
  const Floats v0 = Choose(lines.rows, ends.from_x, ends.from_y);
  const Floats v1 = Choose(lines.rows, ends.to_x, ends.to_y);
  const Floats extent = u1 - u0, farthest = All(kFarthest);
  const Floats near_enough = (cv::v_abs(u0) < farthest) & (cv::v_abs(u1) < farthest) &
                             (cv::v_abs(v0) < farthest) & (cv::v_abs(v1) < farthest);
  const Floats slope = (v1 - v0) / extent;
  const Ints one = All(1), margin = All(kLineMargin);
  const Ints limit = Choose(lines.rows, All(height_), All(width_));
  Ints first = cv::v_max(cv::v_floor(cv::v_min(u0, u1)) - one, margin);
  Ints last = cv::v_min(cv::v_ceil(cv::v_max(u0, u1)) + one, limit - one - margin);
  // Keep the line inside the image across the axis, too.
  const Floats low = All(1.0f);
  const Floats high =
      Choose(lines.rows, All(static_cast<float>(width_ - 3)), All(static_cast<float>(height_ - 3)));
  const Floats steep = cv::v_abs(slope) > All(1e-6f);
  const Floats a = u0 + (low - v0) / slope, b = u0 + (high - v0) / slope;
  const Ints enters = cv::v_ceil(cv::v_max(All(-1.0f), cv::v_min(a, b))) + margin;
  const Ints leaves = cv::v_floor(cv::v_min(farthest, cv::v_max(a, b))) - margin;
  first = Choose(steep, cv::v_max(first, enters), first);
  last = Choose(steep, cv::v_min(last, leaves), last);
  const Ints places = last - first + one;
  const Floats across = v0 + (cv::v_cvt_f32(first) - u0) * slope;

  LineParts parts;
  parts.usable =
      cv::v_signmask((seen.min < seen.max) & near_enough & (cv::v_abs(extent) > All(1e-3f)) &
                     (steep | ((v0 >= low) & (v0 <= high))) &
                     AsMask((places >= All(3)) & (places <= All(kMaxPlaces))));
  Store(parts.first, first);
  Store(parts.places, places);
  Store(parts.across, across);
  Store(parts.slope, slope);
  Store(parts.fixed_across, ToFixed(across - All(static_cast<float>(kLineMargin)) * slope));
  Store(parts.fixed_slope, ToFixed(slope));
  return parts;
}

}  // namespace alidade
