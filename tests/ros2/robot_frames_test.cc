#include "alidade/ros/robot_frames.h"

#include "alidade/geometry/se3.h"

namespace alidade {
namespace {

Se3 At(double x, double z, double yaw = 0) {
  return {ExpSo3({0, yaw, 0}), Eigen::Vector3d(x, 0, z)};  // of a camera: x right, z ahead
}

double Distance(const Se3& a, const Se3& b) { return (a.Inverse() * b).Log().norm(); }

TEST(RobotFrames, TheBaseMovesAheadAlongX) {
  RobotFrames frames(CameraAtBase());
  frames.Add(At(0, 0), std::nullopt);
  EXPECT_LT(Distance(frames.T_map_base(), Se3()), 1e-12);
  frames.Add(At(0, 2), At(0, 0));
  EXPECT_LT((frames.T_map_base().t - Eigen::Vector3d(2, 0, 0)).norm(), 1e-12);
  EXPECT_LT(Distance(frames.T_odom_base(), frames.T_map_base()), 1e-12);
}

TEST(RobotFrames, ACameraOffTheBaseTurnsWithIt) {
  const Se3 T_base_camera = Se3{Eigen::Matrix3d::Identity(), {0.5, 0, 1}} * CameraAtBase();
  RobotFrames frames(T_base_camera);
  frames.Add(Se3(), std::nullopt);
  // The base turns by 90 degrees to the left on the spot.
  const Se3 T_map_base{ExpSo3({0, 0, std::acos(0.0)}), Eigen::Vector3d::Zero()};
  frames.Add(frames.T_map_world().Inverse() * T_map_base * T_base_camera, Se3());
  EXPECT_LT(Distance(frames.T_map_base(), T_map_base), 1e-9);
  EXPECT_LT(Distance(frames.T_odom_base(), T_map_base), 1e-9);
}

TEST(RobotFrames, ACorrectionOfTheMapMovesOdomAndNotTheBaseInIt) {
  RobotFrames frames(CameraAtBase());
  frames.Add(At(0, 0), std::nullopt);
  frames.Add(At(0, 1), At(0, 0));
  // A loop closes: the map says now that the last frame was at (0.3, 0.8), turned.
  const Se3 corrected = At(0.3, 0.8, 0.1);
  frames.Add(corrected * At(0, 0.1), corrected);
  EXPECT_LT((frames.T_odom_base().t - Eigen::Vector3d(1.1, 0, 0)).norm(), 1e-9);
  EXPECT_LT(Distance(frames.T_map_odom() * frames.T_odom_base(), frames.T_map_base()), 1e-9);
  EXPECT_GT(Distance(frames.T_map_odom(), Se3()), 0.1);
}

TEST(RobotFrames, InAnotherMapTheBaseStaysInOdom) {
  RobotFrames frames(CameraAtBase());
  frames.Add(At(0, 0), std::nullopt);
  frames.Add(At(0, 1), At(0, 0));
  const Se3 before = frames.T_odom_base();
  frames.Add(At(5, 5, 1), std::nullopt);
  EXPECT_LT(Distance(frames.T_odom_base(), before), 1e-12);
  EXPECT_LT(Distance(frames.T_map_odom() * before, frames.T_map_base()), 1e-9);
}

}  // namespace
}  // namespace alidade
