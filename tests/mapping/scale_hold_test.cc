// Covariance of a keyframe's center, and the resulting knowledge of scale.
#include "alidade/mapping/scale_hold.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "alidade/geometry/se3.h"
#include "alidade/map/view.h"
#include "problems/synthetic_map.h"

namespace alidade::scale_hold_test {
namespace {

// Gauss-Newton on exact landmarks with noisy observations, the model of the covariance.
Eigen::Vector3d CentreFromNoisyPixels(const MapSnapshot& map, const KeyFrame& keyframe,
                                      const Camera& camera, double sigma, std::mt19937& random) {
  std::normal_distribution<double> noise(0, sigma);
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector2d>> seen;
  std::vector<double> scales;
  for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (!keyframe.landmarks[i].valid()) continue;
    const Eigen::Vector3d p = map.Find(keyframe.landmarks[i])->p_world;
    scales.push_back(ScaleOfLevel(keyframe.frame->keypoints[i].level));
    const double u = noise(random), v = noise(random);
    seen.push_back(
        {p, camera.Project(keyframe.T_camera_world * p) + scales.back() * Eigen::Vector2d(u, v)});
  }
  Se3 T = keyframe.T_camera_world;
  for (int i = 0; i < 5; ++i) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
    for (size_t n = 0; n < seen.size(); ++n) {
      const auto error = [&](const Se3& pose) -> Eigen::Vector2d {
        return (camera.Project(pose * seen[n].first) - seen[n].second) / scales[n];
      };
      Eigen::Matrix<double, 2, 6> J;
      constexpr double kStep = 1e-6;
      for (int k = 0; k < 6; ++k)
        J.col(k) = (error(Se3::Exp(kStep * Vector6d::Unit(k)) * T) - error(T)) / kStep;
      H += J.transpose() * J;
      g += J.transpose() * error(T);
    }
    T = Se3::Exp(-H.inverse() * g) * T;
  }
  return T.Inverse().t;
}

TEST(CentreCovariance, IsThatOfPosesFromNoisyPixels) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 300, .cameras = 4});
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const MapSnapshot map = store.Snapshot();
  const KeyFrame& keyframe = *map.Find(made.keyframes[2]);
  MeasurementNoise noise;
  std::mt19937 random(1);
  constexpr int kTrials = 400;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::Vector3d off =
        CentreFromNoisyPixels(map, keyframe, world.camera, noise.sigma_px, random) -
        keyframe.Centre();
    scatter += off * off.transpose() / kTrials;
  }
  const Eigen::Matrix3d covariance = CentreCovariance(map, keyframe, world.camera, noise);
  // 400 trials determine a standard deviation within 3.5 %.
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(std::sqrt(covariance(k, k) / scatter(k, k)), 1, 0.12) << k;
}

TEST(AtKnownDistance, TellsNothingWhereNoScaleIsKnown) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 300, .cameras = 4});
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const auto known = [&] {
    const MapSnapshot map = store.Snapshot();
    return AtKnownDistance(map, *map.Find(made.keyframes.back()), world.camera, {}).size();
  };
  EXPECT_EQ(known(), 3u);
  store.Commit([&](MapCommit& commit) {
    for (LandmarkId id : made.landmarks) {
      if (id.valid() && commit.Find(id)) commit.Edit(id)->scale_known = false;
    }
  });
  EXPECT_EQ(known(), 0u);
  const MapSnapshot map = store.Snapshot();
  const KeyFrame& last = *map.Find(made.keyframes.back());
  EXPECT_EQ(CountOfKnownScale(map, last), 0);
  EXPECT_TRUE(ScaleFoundFrom(map, last, {}).empty());
  const std::vector<LandmarkId> found = ScaleFoundFrom(map, last, {made.keyframes[0]});
  EXPECT_FALSE(found.empty());
  for (LandmarkId id : found) {
    bool both = false;
    for (const Observation& seen : map.Find(id)->observations)
      both = both || seen.keyframe == made.keyframes[0];
    EXPECT_TRUE(both);
  }
}

}  // namespace
}  // namespace alidade::scale_hold_test
