#include "alidade/dynamics/evidence.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

// Share of a value that passes to a neighboring cell: 1 - (|z - z'| / (spread_step min(z, z')))².
float Passes(std::span<const float> depth, int a, int b, const CellDepthSettings& settings) {
  if (depth.empty()) return 1;
  if (!(depth[a] > 0) || !(depth[b] > 0)) return settings.spread_unmeasured;
  const float step =
      std::abs(depth[a] - depth[b]) / (settings.spread_step * std::min(depth[a], depth[b]));
  return step > 1 ? 0 : 1 - step * step;
}

}  // namespace

DepthComparison CompareDepth(const Cells& cells, std::span<const float> depth,
                             const Se3& T_camera_world, const PastView& past,
                             const CellDepthSettings& settings) {
  DepthComparison comparison;
  comparison.result.assign(cells.count(), Comparison::kUnknown);
  comparison.met.assign(cells.count(), -1);
  const Se3 T_past_now = past.T_camera_world * T_camera_world.Inverse();
  for (int i = 0; i < cells.count(); ++i) {
    if (!(depth[i] > 0)) continue;
    const Eigen::Vector3d p = T_past_now * (depth[i] * cells.Ray(i));
    const int there = cells.Project(p);
    if (there < 0) continue;
    const auto z = static_cast<float>(p.z());
    const float tolerance = DepthTolerance(std::max(z, depth[i]), settings);
    float nearest_to = 1e9f;  // signed depth difference of the best matching neighbor
    int known = 0, met = -1;
    cells.VisitAround(there, 1, [&](int n) {
      if (!(past.depth[n] > 0)) return;
      ++known;
      const float off = past.depth[n] - z;
      if (std::abs(off) < std::abs(nearest_to)) {
        nearest_to = off;
        met = n;
      }
    });
    if (known == 0) continue;
    if (std::abs(nearest_to) <= tolerance) {
      comparison.result[i] = Comparison::kSame;
      comparison.met[i] = met;
    } else if (nearest_to > settings.free_tolerances * tolerance &&
               known >= settings.free_neighbours) {
      // The best matching neighbor is behind the point: check that all neighbors with depth are.
      bool free = true;
      cells.VisitAround(there, 1,
                        [&](int n) { free &= !(past.depth[n] > 0) || past.depth[n] > z; });
      if (free) comparison.result[i] = Comparison::kFree;
    }
  }
  return comparison;
}

EpipolarSegment SegmentOf(const Camera& camera, const Eigen::Vector3d& ray, const Se3& T_now_then,
                          double min_inverse_depth, double max_inverse_depth) {
  constexpr double kLeastDepth = 1e-3;  // of the depth in the earlier view
  EpipolarSegment segment;
  const auto at = [&](double inverse_depth) -> Eigen::Vector3d {
    return T_now_then.R * ray + inverse_depth * T_now_then.t;
  };
  Eigen::Vector3d far = at(min_inverse_depth), near = at(max_inverse_depth);
  if (far.z() < kLeastDepth && near.z() < kLeastDepth) {
    segment.in_front = false;
    return segment;
  }
  // Clip the part of the segment that is behind the camera.
  const auto cut = [&](Eigen::Vector3d& behind, const Eigen::Vector3d& seen) {
    const double share = (seen.z() - kLeastDepth) / (seen.z() - behind.z());
    behind = seen + share * (behind - seen);
  };
  if (far.z() < kLeastDepth) cut(far, near);
  if (near.z() < kLeastDepth) cut(near, far);
  segment.from = camera.Project(far);
  segment.to = camera.Project(near);
  return segment;
}

double DistanceTo(const EpipolarSegment& segment, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d along = segment.to - segment.from;
  const double length2 = along.squaredNorm();
  const double share =
      length2 > 0 ? std::clamp((pixel - segment.from).dot(along) / length2, 0.0, 1.0) : 0;
  return (pixel - segment.from - share * along).norm();
}

void SpreadOverSurfaces(const Cells& cells, std::span<const float> depth, float fade,
                        std::vector<float>& values, std::vector<float>& weights,
                        const CellDepthSettings& settings) {
  for (int i = 0; i < cells.count(); ++i) values[i] *= weights[i];
  const auto pass = [&](int from, int to) {
    const float share = fade * Passes(depth, from, to, settings);
    values[to] += share * (values[from] - values[to]);
    weights[to] += share * (weights[from] - weights[to]);
  };
  const int columns = cells.columns(), rows = cells.rows();
  for (int round = 0; round < 2; ++round) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 1; c < columns; ++c) pass(r * columns + c - 1, r * columns + c);
      for (int c = columns - 1; c-- > 0;) pass(r * columns + c + 1, r * columns + c);
    }
    for (int c = 0; c < columns; ++c) {
      for (int r = 1; r < rows; ++r) pass((r - 1) * columns + c, r * columns + c);
      for (int r = rows - 1; r-- > 0;) pass((r + 1) * columns + c, r * columns + c);
    }
  }
  for (int i = 0; i < cells.count(); ++i)
    values[i] = weights[i] > 1e-6f ? values[i] / weights[i] : 0;
}

}  // namespace alidade
