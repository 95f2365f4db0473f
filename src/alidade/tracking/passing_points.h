// Temporary points on objects that are possibly static, such as a seated person. They contribute to
// the pose with their static probability while they are consistent, and never enter the map.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "alidade/features/descriptor.h"
#include "alidade/geometry/camera.h"
#include "alidade/tracking/placed_frame.h"

namespace alidade {

class PassingPoints {
 public:
  explicit PassingPoints(const Camera& camera) : camera_(camera) {}

  // Finds the points near their predicted positions, at keypoints of uncertain static probability
  // (Frame::kUsable to kMappable) without a landmark. `radius`: pixels on level 0; `max_distance`:
  // Hamming distance, bits.
  std::vector<PassingMatch> Find(const PlacedFrame& placed, float radius, int max_distance) const;
  // After the pose estimate: keeps the points consistent with it (placed.passing) and adds the
  // frame's other uncertain keypoints with depth. A changed `world` (count of map corrections)
  // invalidates all points.
  void Update(const PlacedFrame& placed, uint64_t world);
  void Clear() { points_.clear(); }
  size_t size() const { return points_.size(); }

 private:
  struct Point {
    Eigen::Vector3d p_world;
    Descriptor descriptor;
    int level = 0;  // level of the last match
    int age = 0;    // frames
  };

  Camera camera_;
  std::vector<Point> points_;
  uint64_t world_ = 0;
};

}  // namespace alidade
