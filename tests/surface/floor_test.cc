#include "alidade/surface/floor.h"

#include <gtest/gtest.h>

#include "support/dense_views.h"

namespace alidade::floor_test {
namespace {

TEST(Floor, OfARoomIsFoundThoughItsTablesAreLarger) {
  const SynthRecording recording(SmallRoom());
  const auto views = DenseViewsOf(recording, 60, DepthOf::kSensor);
  // 40° off, as the up direction of a camera that looks down
  const Eigen::Vector3d up =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ();
  const auto floor = FindFloor(views, up);
  ASSERT_TRUE(floor);
  EXPECT_GT(floor->up.z(), std::cos(0.01));  // 0.6°
  EXPECT_NEAR(floor->height, 0, 0.02);
  EXPECT_LT(floor->sigma, 0.04);  // twice the noise of 640 pixels
}

TEST(Floor, IsNotAWallNorWhatTheCameraIsBelow) {
  const DenseView ahead = FlatView(2);  // y is down: its up is -y
  EXPECT_FALSE(FindFloor({ahead}, -Eigen::Vector3d::UnitY()));
  EXPECT_FALSE(FindFloor({ahead}, Eigen::Vector3d::UnitZ()));  // a ceiling
  const auto floor = FindFloor({ahead}, -Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(floor);
  EXPECT_NEAR(floor->height, -2, 1e-6);
}

TEST(Floor, FrameHasZUpFromTheFloorAndXAlongTheRobot) {
  Floor floor;
  floor.up = -Eigen::Vector3d::UnitY();
  floor.height = -1.2;  // 1.2 m below a camera at the origin
  const Se3 T = floor.FrameFor({0.5, 0, 0}, Eigen::Vector3d(0, 0.7, 0.7));
  EXPECT_TRUE((T * Eigen::Vector3d(0.5, 1.2, 0)).isZero(1e-12));
  EXPECT_TRUE((T * Eigen::Vector3d(0.5, 1.2, 1)).isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE((T * Eigen::Vector3d(0.5, 0.2, 0)).isApprox(Eigen::Vector3d::UnitZ()));
}

}  // namespace
}  // namespace alidade::floor_test
