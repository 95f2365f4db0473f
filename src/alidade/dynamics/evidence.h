// Geometric evidence of motion: depth compared with an earlier view, optical flow compared with the
// pose.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/history.h"
#include "alidade/geometry/se3.h"

namespace alidade {

// Largest depth difference within one surface, meters: a + b z + c z².
inline float DepthTolerance(float z, const CellDepthSettings& settings = {}) {
  return settings.tolerance + settings.tolerance_linear * z + settings.tolerance_square * z * z;
}

enum class Comparison : uint8_t {
  kUnknown,  // not visible in the earlier view, or occluded
  kSame,     // the earlier view shows a surface at this position
  kFree      // the earlier view saw through this position: the surface appeared since
};

// Compares every cell with an earlier view; `met` is the matching cell of that view, or -1.
// Let z be the depth of the cell's surface in the earlier view, z' the depth measured there, taken
// from the one of the nine cells around the projection that matches best (so that outlines do not
// count), and t = DepthTolerance.
// kSame: |z' - z| <= t.
// kFree: z' - z > free_tolerances t, and at least free_neighbours of the nine cells have depth, all
// of them farther than z.
// Bescos et al. 2018, §III-C.
struct DepthComparison {
  std::vector<Comparison> result;
  std::vector<int> met;
};
DepthComparison CompareDepth(const Cells& cells, std::span<const float> depth,
                             const Se3& T_camera_world, const PastView& past,
                             const CellDepthSettings& settings = {});

// Where a point seen at a pixel of an earlier view may appear now: a segment of its epipolar line.
struct EpipolarSegment {
  Eigen::Vector2d from, to;  // undistorted pixels at the smallest and the largest inverse depth
  bool in_front = true;      // false: the point would be behind the camera
};
// `ray`: (x/z, y/z, 1) in the earlier view. Inverse depths in the earlier view, 1/meters; 0 means
// infinitely far.
EpipolarSegment SegmentOf(const Camera& camera, const Eigen::Vector3d& ray, const Se3& T_now_then,
                          double min_inverse_depth, double max_inverse_depth);
double DistanceTo(const EpipolarSegment& segment, const Eigen::Vector2d& pixel);  // pixels

// Propagates the values of cells over the surfaces they are on: a weighted average whose kernel
// decays by `fade` from cell to cell and does not cross depth discontinuities. Without depth it
// crosses everything. `weights`: weight of each cell's own value; on return, the total weight
// received. Recursive filtering, Gastal & Oliveira 2011.
void SpreadOverSurfaces(const Cells& cells, std::span<const float> depth, float fade,
                        std::vector<float>& values, std::vector<float>& weights,
                        const CellDepthSettings& settings = {});

}  // namespace alidade
