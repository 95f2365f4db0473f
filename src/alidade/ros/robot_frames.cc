#include "alidade/ros/robot_frames.h"

#include "alidade/ros/ros_log.h"

namespace alidade {

Se3 CameraAtBase() { return {BodyAxesFromOptical(), Eigen::Vector3d::Zero()}; }

RobotFrames::RobotFrames(const Se3& T_base_camera) : T_base_camera_(T_base_camera) {}

void RobotFrames::Add(const Se3& T_world_camera, const std::optional<Se3>& T_world_last_camera) {
  const Se3 T_camera_base = T_base_camera_.Inverse();
  T_map_base_ = T_map_world() * T_world_camera * T_camera_base;
  step_ = Se3();
  if (!T_world_last_camera) return;
  step_ = T_base_camera_ * T_world_last_camera->Inverse() * T_world_camera * T_camera_base;
  T_odom_base_ = (T_odom_base_ * step_).Normalised();
}

}  // namespace alidade
