#include "alidade/view/upright.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace alidade::upright_test {
namespace {

constexpr double kDegree = 3.141592653589793 / 180;

// In a world with y down: rotated about the vertical, then pitched down.
Se3 Held(double yaw, double pitch_down, double roll = 0) {
  return {ExpSo3({0, yaw, 0}) * ExpSo3({-pitch_down, 0, 0}) * ExpSo3({0, 0, roll}),
          Eigen::Vector3d::Zero()};
}

double AngleFromUp(const Eigen::Matrix3d& axes) {
  return std::acos(std::min(1.0, axes.row(2).dot(Eigen::RowVector3d(0, -1, 0)))) / kDegree;
}

TEST(Upright, CamerasThatLookDownDoNotTiltTheWorld) {
  std::vector<Se3> stretch;
  for (int i = -30; i <= 30; ++i) {
    const double roll = (i % 3 - 1) * 2 * kDegree;
    stretch.push_back(Held(i * kDegree, 35 * kDegree, roll));
  }
  const Eigen::Matrix3d axes = UprightAxes({stretch});
  EXPECT_LT(AngleFromUp(axes), 5);  // their own up axes are off by 35 degrees
  EXPECT_LT((axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(axes.determinant(), -1 * -1, 1e-12);  // right, forward, up: right-handed
}

TEST(Upright, WithoutTurningTheCamerasOwnUpDecides) {
  const Eigen::Matrix3d axes = UprightAxes({{Held(0.3, 0.2), Held(0.3, 0.2)}});
  EXPECT_NEAR(AngleFromUp(axes), 0.2 / kDegree, 1e-6);
}

TEST(Upright, IsAgainstGravityWhereThatIsKnown) {
  const Eigen::Vector3d down = Eigen::Vector3d(0.3, 0.9, 0.1).normalized();
  const Eigen::Matrix3d axes = UprightAxes({{Held(0.3, 0.2), Held(0.5, 0.4)}}, down);
  EXPECT_LT((axes * down + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(axes.determinant(), 1, 1e-12);
}

TEST(Upright, WithoutAPathIsTheWorldsOwnCamera) {
  const Eigen::Matrix3d axes = UprightAxes({});
  EXPECT_EQ(axes.row(0), Eigen::RowVector3d(1, 0, 0));
  EXPECT_EQ(axes.row(1), Eigen::RowVector3d(0, 0, 1));
  EXPECT_EQ(axes.row(2), Eigen::RowVector3d(0, -1, 0));
}

}  // namespace
}  // namespace alidade::upright_test
