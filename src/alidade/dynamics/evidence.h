// What geometry says about what moves: depth against an earlier view, flow against the pose.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/history.h"
#include "alidade/geometry/se3.h"

namespace alidade {

// How far two depths of one surface may be apart, metres: a + b z + c z².
inline float DepthTolerance(float z, const CellDepthSettings& settings = {}) {
  return settings.tolerance + settings.tolerance_linear * z + settings.tolerance_square * z * z;
}

enum class Comparison : uint8_t {
  kUnknown,  // not seen then, or hidden
  kSame,     // there was a surface at that place
  kFree      // one looked through the place: what is there now has come since
};

// Every cell of the present view against an earlier one; also says which cell of it was met (-1).
// Seen from there the cell's surface is at depth z; z' is the depth measured then, of the nine
// cells around that which agrees best, so that outlines do not count; t is DepthTolerance:
//   |z' - z| <= t              the same
//   z' - z > free_tolerances t  free, if all of the nine that have depth, and enough have, are
//                              farther than z
// Bescos et al. 2018, §III-C.
struct DepthComparison {
  std::vector<Comparison> result;
  std::vector<int> met;
};
DepthComparison CompareDepth(const Cells& cells, std::span<const float> depth,
                             const Se3& T_camera_world, const PastView& past,
                             const CellDepthSettings& settings = {});

// Where a point seen at an earlier pixel may be now: a piece of its epipolar line.
struct EpipolarSegment {
  Eigen::Vector2d from, to;  // at the least and the most inverse depth, undistorted pixels
  bool in_front = true;      // false: it could not be seen now
};
// `ray`: (x/z, y/z, 1) then; inverse depths then, 1/metres, may be 0 (infinitely far).
EpipolarSegment SegmentOf(const Camera& camera, const Eigen::Vector3d& ray, const Se3& T_now_then,
                          double min_inverse_depth, double max_inverse_depth);
double DistanceTo(const EpipolarSegment& segment, const Eigen::Vector2d& pixel);  // pixels

// Spreads what is known of some cells over the surface they are on: a weighted average that fades
// with distance, to `fade` from cell to cell, and does not cross steps of depth. Without depth it
// crosses everything. `weights`: how much each cell's own value counts; afterwards, how much was
// heard there. Gastal & Oliveira 2011 (recursive filtering).
void SpreadOverSurfaces(const Cells& cells, std::span<const float> depth, float fade,
                        std::vector<float>& values, std::vector<float>& weights,
                        const CellDepthSettings& settings = {});

}  // namespace alidade
