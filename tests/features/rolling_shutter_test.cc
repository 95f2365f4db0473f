// Rolling-shutter correction of keypoints.
#include "alidade/features/rolling_shutter.h"

#include <gtest/gtest.h>

#include <vector>

#include "alidade/base/random.h"

namespace alidade::rolling_shutter_test {
namespace {

// Chosen so that keypoints are displaced by up to 8 pixels.
const Vector6d kMotion = (Vector6d() << 0.3, -0.2, 0.4, 0.5, -0.6, 0.3).finished();

Camera Rolling(std::array<double, 2> readout) {
  Camera camera = Camera::FromFieldOfView(640, 480, 66);
  camera.distortion = {-0.1, 0.02, 0, 0, 0};
  camera.readout = readout;
  return camera;
}

struct View {
  Frame frame;
  std::vector<Eigen::Vector2d> at_once;  // undistorted positions for a global shutter
  std::vector<float> inverse_depths;
};

// Fixed-point iteration: the position depends on the readout time of its row, which depends on the
// position.
View Take(const Camera& camera, bool far) {
  View view;
  Random random(5);
  while (view.at_once.size() < 300) {
    Eigen::Vector3d p(random.Uniform(-3, 3), random.Uniform(-2, 2), random.Uniform(2, 6));
    if (far) p *= 1000;
    Eigen::Vector2d raw = camera.Distort(camera.Project(p));
    for (int i = 0; i < 30; ++i) {
      const double seconds = camera.ReadAfterMiddle(raw.x(), raw.y());
      raw = camera.Distort(camera.Project(Se3::Exp(seconds * kMotion) * p));
    }
    if (!(raw.x() > 0 && raw.x() < 639 && raw.y() > 0 && raw.y() < 479)) continue;
    Keypoint keypoint;
    const Eigen::Vector2d ideal = camera.Undistort(raw);
    keypoint.raw_x = static_cast<float>(raw.x());
    keypoint.raw_y = static_cast<float>(raw.y());
    keypoint.x = static_cast<float>(ideal.x());
    keypoint.y = static_cast<float>(ideal.y());
    keypoint.depth = 2;
    keypoint.right_x = keypoint.x - 20;
    view.frame.keypoints.push_back(keypoint);
    view.at_once.push_back(camera.Project(p));
    view.inverse_depths.push_back(static_cast<float>(1 / p.z()));
  }
  return view;
}

double WorstShift(const View& view) {
  double worst = 0;
  for (size_t i = 0; i < view.at_once.size(); ++i)
    worst = std::max(worst, (view.frame.keypoints[i].pixel() - view.at_once[i]).norm());
  return worst;
}

TEST(RollingShutter, IsUndoneForPointsOfKnownDepthInEitherDirection) {
  for (const std::array<double, 2>& readout : {std::array{0.0, 0.03}, std::array{-0.02, 0.0}}) {
    const Camera camera = Rolling(readout);
    View view = Take(camera, false);
    ASSERT_GT(WorstShift(view), 3);
    UndoRollingShutter(camera, kMotion, view.inverse_depths, 0, view.frame);
    // The depth at the row's readout time differs slightly from that at the middle.
    EXPECT_LT(WorstShift(view), 0.1);
    EXPECT_EQ(view.frame.motion, kMotion);
    for (const Keypoint& k : view.frame.keypoints) EXPECT_NEAR(k.x - k.right_x, 20, 1e-3);
    // The correction is idempotent, because it starts from the raw positions.
    const std::vector<Keypoint> once = view.frame.keypoints;
    UndoRollingShutter(camera, kMotion, view.inverse_depths, 0, view.frame);
    for (size_t i = 0; i < once.size(); ++i) EXPECT_EQ(once[i].x, view.frame.keypoints[i].x);
  }
}

TEST(RollingShutter, WhatIsNotKnownIsTakenToBeAsFarAsTheRest) {
  const Camera camera = Rolling({0, 0.03});
  View near = Take(camera, false), far = Take(camera, true);
  const double before = WorstShift(near);
  UndoRollingShutter(camera, kMotion, {}, 1 / 3.5, near.frame);
  EXPECT_LT(WorstShift(near), 0.5 * before);
  // Distant points are displaced by rotation only.
  UndoRollingShutter(camera, kMotion, {}, 0, far.frame);
  EXPECT_LT(WorstShift(far), 0.01);
}

TEST(RollingShutter, KeypointsAreFoundWhereTheyAreNow) {
  const Camera camera = Rolling({0, 0.03});
  View view = Take(camera, false);
  view.frame.grid = KeypointGrid(view.frame.keypoints, 640, 480);
  UndoRollingShutter(camera, kMotion, view.inverse_depths, 0, view.frame);
  for (int i = 0; i < 300; ++i) {
    const Keypoint& k = view.frame.keypoints[static_cast<size_t>(i)];
    bool found = false;
    view.frame.grid.VisitNear(k.x, k.y, 1, [&](int other) { found = found || other == i; });
    EXPECT_TRUE(found) << i;
  }
}

TEST(RollingShutter, OfACameraThatReadsAtOnceNothingMoves) {
  const Camera camera = Rolling({0, 0});
  View view = Take(camera, false);
  const std::vector<Keypoint> before = view.frame.keypoints;
  UndoRollingShutter(camera, kMotion, view.inverse_depths, 0, view.frame);
  for (size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(before[i].x, view.frame.keypoints[i].x);
    EXPECT_EQ(before[i].y, view.frame.keypoints[i].y);
  }
  EXPECT_EQ(view.frame.motion, kMotion);
}

}  // namespace
}  // namespace alidade::rolling_shutter_test
