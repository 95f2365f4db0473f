// Observations and points that are wrong, behind a camera, or hardly trusted.
#include <gtest/gtest.h>

#include <limits>

#include "alidade/optimize/bundle_adjustment.h"
#include "optimize/bundle_errors.h"
#include "problems/bundle_problem.h"

namespace alidade::bundle_outliers_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(AdjustBundle, LeavesOutWhatIsNotANumber) {
  const BundleProblem clean = MakeBundleProblem({.seed = 30});
  BundleProblem dirty = clean;
  BundleObservation o = dirty.observations[5];
  o.pixel.x() = kNaN;
  dirty.observations.push_back(o);
  o = dirty.observations[6];
  o.inv_sigma2 = kNaN;
  dirty.observations.push_back(o);
  o.inv_sigma2 = -1;
  dirty.observations.push_back(o);
  o = dirty.observations[7];
  o.point = static_cast<int>(dirty.points.size());
  dirty.points.emplace_back(kNaN, 0, 1);
  dirty.observations.push_back(o);
  o = dirty.observations[8];
  o.camera = static_cast<int>(dirty.fixed.size());
  dirty.T_camera_world.push_back(clean.T_camera_world[0]);
  dirty.T_camera_world.back().t.x() = kNaN;
  dirty.fixed.push_back(0);
  dirty.observations.push_back(o);

  BundleProblem expected = clean;
  const BundleReport a = AdjustBundle(expected), b = AdjustBundle(dirty);
  EXPECT_EQ(a.final_cost, b.final_cost);
  EXPECT_TRUE(std::isnan(dirty.points.back().x()));
  dirty.points.pop_back();
  dirty.T_camera_world.pop_back();
  EXPECT_TRUE(SameBits(expected, dirty));
}

TEST(AdjustBundle, LeavesOutWhatStartsBehindTheCamera) {
  const BundleProblem clean = MakeBundleProblem({.seed = 31});
  BundleProblem problem = clean;
  BundleObservation o = problem.observations[0];
  o.point = static_cast<int>(problem.points.size());
  problem.points.push_back(problem.T_camera_world[o.camera].Inverse() * Eigen::Vector3d(0, 0, -2));
  problem.observations.push_back(o);
  BundleProblem expected = clean;
  EXPECT_EQ(AdjustBundle(problem).final_cost, AdjustBundle(expected).final_cost);
  EXPECT_EQ(ChiSquared(problem.camera, clean.T_camera_world[o.camera], problem.points.back(), o),
            std::numeric_limits<double>::infinity());
}

TEST(AdjustBundle, NoPointEndsBehindACameraThatSeesIt) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    // Distant wrong matches pull points through the cameras.
    BundleProblem problem = MakeBundleProblem(
        {.max_track = 3, .stereo = 0, .outliers = 0.3, .outlier_px = 400, .seed = seed});
    ASSERT_TRUE(std::isfinite(CostOf(problem)));
    const BundleReport report = AdjustBundle(problem, {.max_iterations = 40});
    EXPECT_LT(report.final_cost, report.initial_cost);
    EXPECT_NEAR(CostOf(problem), report.final_cost, 1e-9 * report.initial_cost);
  }
}

TEST(AdjustBundle, APointThatCannotMoveForwardHoldsNobodyBack) {
  const BundleProblem clean = MakeBundleProblem({.stereo = 1, .noise_px = 0.5, .seed = 32});
  BundleProblem problem = clean;
  // Very close to its camera, and pulled far behind it by a negative disparity.
  BundleObservation o = problem.observations[0];
  o.point = static_cast<int>(problem.points.size());
  o.camera = 0;
  o.pixel = {320, 240, 420};
  problem.points.push_back(problem.T_camera_world[0].Inverse() * Eigen::Vector3d(0, 0, 0.05));
  problem.observations.push_back(o);
  BundleProblem expected = clean;
  const BundleSettings settings{.max_iterations = 60, .min_relative_decrease = 1e-10};
  AdjustBundle(expected, settings);
  AdjustBundle(problem, settings);
  problem.points.pop_back();
  EXPECT_LT(LargestPointError(problem, expected), 1e-3);
}

// Points that moved while the cameras passed: all pull the cameras in the same direction.
TEST(AdjustBundle, WhatIsHardlyTrustedHardlyPulls) {
  const BundleProblem clean = MakeBundleProblem({.stereo = 1, .noise_px = 0.5, .seed = 35});
  const auto walking = [](const BundleObservation& o) { return o.point % 3 == 0; };
  const BundleSettings settings{.max_iterations = 60, .min_relative_decrease = 1e-10};
  const auto pulled_by = [&](double trust) {
    BundleProblem without = clean, with = clean;
    std::erase_if(without.observations, walking);
    for (BundleObservation& o : with.observations) {
      if (!walking(o)) continue;
      o.pixel.x() += 3.0 * o.camera;
      o.pixel.z() += 3.0 * o.camera;
      o.trust = trust;
    }
    AdjustBundle(without, settings);
    const BundleReport report = AdjustBundle(with, settings);
    EXPECT_NEAR(report.final_cost, CostOf(with), 1e-9 * report.initial_cost);
    return LargestCameraError(without, with);
  };
  EXPECT_GT(pulled_by(1), 0.01);  // meters
  EXPECT_LT(pulled_by(1e-3), 0.001);
  EXPECT_EQ(pulled_by(0), 0);
}

TEST(AdjustBundle, PointsSeenOnceByOneEyeDoNoHarm) {
  const BundleProblem clean = MakeBundleProblem({.seed = 33});
  BundleProblem problem = clean;
  Random random(4);
  for (int i = 0; i < 40; ++i) {
    BundleObservation o;
    o.camera = i % static_cast<int>(problem.fixed.size());
    o.point = static_cast<int>(problem.points.size());
    o.pixel = {random.Uniform(0, 640), random.Uniform(0, 480), kNaN};
    const Eigen::Vector3d p =
        problem.camera.Unproject(o.pixel.head<2>() + Eigen::Vector2d(3, 2), 4);
    problem.points.push_back(problem.T_camera_world[o.camera].Inverse() * p);
    problem.observations.push_back(o);
  }
  BundleProblem expected = clean;
  const BundleSettings settings{.max_iterations = 100, .min_relative_decrease = 1e-12};
  const double cost = AdjustBundle(expected, settings).final_cost;
  // Each can be explained completely, and therefore adds no cost.
  EXPECT_NEAR(AdjustBundle(problem, settings).final_cost, cost, 1e-6 * cost);
  for (const Eigen::Vector3d& p : problem.points) EXPECT_TRUE(p.allFinite());
}

}  // namespace
}  // namespace alidade::bundle_outliers_test
