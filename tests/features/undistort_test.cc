#include "alidade/features/undistort.h"

#include <gtest/gtest.h>

namespace alidade::undistort_test {
namespace {

TEST(UndistortKeypoints, PutsThemWhereTheCameraSeesThem) {
  Camera camera = Camera::FromFieldOfView(400, 300, 70);
  camera.distortion = {-0.2, 0.05, 0, 0, 0};
  Frame frame;
  for (int i = 0; i < 12; ++i) {
    Keypoint k;
    k.raw_x = static_cast<float>(20 + 30 * i);
    k.raw_y = static_cast<float>(280 - 20 * i);
    k.x = k.y = -1;  // result of a previous camera model
    frame.keypoints.push_back(k);
  }
  UndistortKeypoints(camera, frame);
  for (const Keypoint& k : frame.keypoints) {
    const Eigen::Vector2d ideal = camera.Undistort({k.raw_x, k.raw_y});
    EXPECT_NEAR((k.pixel() - ideal).norm(), 0, 1e-4);
    int near = 0;  // the grid contains the new positions
    frame.grid.VisitNear(k.x, k.y, 1, [&](int i) { near += frame.keypoints[i].x == k.x; });
    EXPECT_EQ(near, 1);
  }
  camera.distortion = {};
  UndistortKeypoints(camera, frame);
  for (const Keypoint& k : frame.keypoints) {
    EXPECT_EQ(k.x, k.raw_x);
    EXPECT_EQ(k.y, k.raw_y);
  }
}

}  // namespace
}  // namespace alidade::undistort_test
