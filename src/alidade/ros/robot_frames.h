// The frames of a mobile robot (REP 105) from the poses of its camera.
#pragma once

#include <optional>

#include "alidade/geometry/se3.h"

namespace alidade {

// Where the camera is if nobody tells: at the base, which looks along its x axis (REP 103).
Se3 CameraAtBase();

// `map`: the place, with its origin and axes where the base was at the first frame; the base's pose
// in it is the best known and jumps when the map is corrected. `odom`: the base's pose in it is the
// sum of its motions from frame to frame, without corrections of the map. One thread.
class RobotFrames {
 public:
  // `T_base_camera`: of the camera as mounted.
  explicit RobotFrames(const Se3& T_base_camera);

  // A frame with a pose, and the last frame that was given here, in the same world, as far from
  // each other as the camera moved; nullopt: how far it moved is unknown, and the base stays in
  // odom.
  void Add(const Se3& T_world_camera, const std::optional<Se3>& T_world_last_camera);

  const Se3& T_map_world() const { return T_base_camera_; }
  const Se3& T_odom_base() const { return T_odom_base_; }
  const Se3& T_map_base() const { return T_map_base_; }
  Se3 T_map_odom() const { return T_map_base_ * T_odom_base_.Inverse(); }
  const Se3& step() const { return step_; }  // T_last base_base

 private:
  Se3 T_base_camera_, T_odom_base_, T_map_base_, step_;
};

}  // namespace alidade
