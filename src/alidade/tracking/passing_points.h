// Points on what may stand still and is not certain to, such as someone who sits: they help the
// pose for as long as they hold, by their probability, and never enter the map.
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

  // Those that the frame shows near where they should be seen, at keypoints which may stand still
  // but are not certain to (Frame::kUsable … kMappable) and are no landmark's. `radius`: pixels at
  // level 0; `max_distance`: bits.
  std::vector<PassingMatch> Find(const PlacedFrame& placed, float radius, int max_distance) const;
  // After the pose: keeps the points that agreed with it (placed.passing) and takes on the frame's
  // other doubtful keypoints with depth. `world`: changes when poses of another are no longer
  // comparable; then nothing is kept.
  void Update(const PlacedFrame& placed, uint64_t world);
  void Clear() { points_.clear(); }
  size_t size() const { return points_.size(); }

 private:
  struct Point {
    Eigen::Vector3d p_world;
    Descriptor descriptor;
    int level = 0;  // it was last found on
    int age = 0;    // frames
  };

  Camera camera_;
  std::vector<Point> points_;
  uint64_t world_ = 0;
};

}  // namespace alidade
