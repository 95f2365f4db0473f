#include "alidade/map/landmark_covariance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "map/two_keyframes.h"

namespace alidade::landmark_covariance_test {
namespace {

Camera Pinhole() { return Camera::FromFieldOfView(640, 480, 60); }

// Two cameras 1 m apart that look ahead at a point 3 m away, half way between them: z = f b / d and
// x = z u / f with independent errors s of both columns, so sigma_z = sqrt(2) s z² / (f b), sigma_x
// = s z / (sqrt(2) f); of the rows sigma_y = s z / (sqrt(2) f).
TEST(LandmarkCovariance, OfTwoViewsIsThatOfTriangulation) {
  MapStore store;
  LandmarkId id;
  store.Commit([&](MapCommit& commit) {
    const KeyFrameId a = commit.Add(BareKeyFrame(1, {}, Sideways(0.5)));
    const KeyFrameId b = commit.Add(BareKeyFrame(1, a, Sideways(-0.5)));
    id = commit.Add(SeenBy({{a, 0}, {b, 0}}));
  });
  const Camera camera = Pinhole();
  const double s = 2, z = 3;
  const auto covariance = LandmarkCovariance(store.Snapshot(), id, camera, {.sigma_px = s});
  ASSERT_TRUE(covariance);
  EXPECT_NEAR(std::sqrt((*covariance)(2, 2)), std::sqrt(2.0) * s * z * z / camera.fx, 1e-9);
  EXPECT_NEAR(std::sqrt((*covariance)(0, 0)), s * z / (std::sqrt(2.0) * camera.fx), 1e-9);
  // The rows also tell a little of the depth, but nothing here, where y = 0.
  EXPECT_NEAR(std::sqrt((*covariance)(1, 1)), s * z / (std::sqrt(2.0) * camera.fy), 1e-9);
  EXPECT_NEAR((*covariance)(0, 2), 0, 1e-12);
}

TEST(LandmarkCovariance, TurnsWithTheWorld) {
  const Se3 turned = Se3::Exp((Vector6d() << 0.3, -0.2, 0.5, 0.4, 1.1, -0.7).finished());
  const auto of = [&](const Se3& T_new_world) {
    MapStore store;
    LandmarkId id;
    store.Commit([&](MapCommit& commit) {
      const Se3 T = T_new_world.Inverse();
      const KeyFrameId a = commit.Add(BareKeyFrame(1, {}, Sideways(0.2) * T));
      const KeyFrameId b = commit.Add(BareKeyFrame(1, a, Sideways(-0.7) * T));
      Landmark landmark = SeenBy({{a, 0}, {b, 0}});
      landmark.p_world = T_new_world * landmark.p_world;
      id = commit.Add(landmark);
    });
    return *LandmarkCovariance(store.Snapshot(), id, Pinhole());
  };
  const Eigen::Matrix3d expected = turned.R * of({}) * turned.R.transpose();
  EXPECT_LT((of(turned) - expected).norm(), 1e-9 * expected.norm());
}

using LandmarkCovarianceUnknown = TwoKeyframes;
TEST_F(LandmarkCovarianceUnknown, WhenTheDepthIsNotDetermined) {
  EXPECT_TRUE(LandmarkCovariance(store_.Snapshot(), both_, Pinhole()));
  EXPECT_FALSE(LandmarkCovariance(store_.Snapshot(), in_b_, Pinhole()));
  EXPECT_FALSE(LandmarkCovariance(store_.Snapshot(), LandmarkId{99}, Pinhole()));
  store_.Commit([&](MapCommit& commit) { commit.Edit(both_)->depth_assumed = true; });
  EXPECT_FALSE(LandmarkCovariance(store_.Snapshot(), both_, Pinhole()));
}

}  // namespace
}  // namespace alidade::landmark_covariance_test
