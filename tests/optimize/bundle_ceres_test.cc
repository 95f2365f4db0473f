// Comparison of AdjustBundle() with Ceres.
#include <gtest/gtest.h>

#include "alidade/optimize/bundle_schur.h"
#include "ceres_bundle.h"
#include "problems/bundle_problem.h"

namespace alidade::bundle_ceres_test {
namespace {

constexpr BundleSettings kToTheEnd{.max_iterations = 400, .min_relative_decrease = 1e-15};

// Same start; costs are compared as computed by Ceres.
void ExpectSameOptimum(const BundleProblemOptions& options, double tolerance = 1e-6) {
  const BundleProblem problem = MakeBundleProblem(options);
  BundleProblem ours = problem, theirs = problem;
  const BundleReport report = AdjustBundle(ours, kToTheEnd);
  const ceres::Solver::Summary summary = AdjustWithCeres(theirs, kToTheEnd);
  EXPECT_NEAR(report.initial_cost, summary.initial_cost, 1e-9 * summary.initial_cost);
  EXPECT_NEAR(report.final_cost, summary.final_cost, tolerance * summary.final_cost)
      << summary.BriefReport() << " ours " << report.iterations;
  // Check that the returned state has the reported cost, as computed by Ceres.
  CeresBundleOptions no_steps;
  no_steps.max_iterations = 0;
  EXPECT_NEAR(AdjustWithCeres(ours, kToTheEnd, no_steps).initial_cost, report.final_cost,
              1e-9 * report.final_cost);
}

TEST(BundleAgainstCeres, SameOptimumOnMonocularProblems) {
  for (uint64_t seed = 1; seed <= 3; ++seed) ExpectSameOptimum({.stereo = 0, .seed = seed});
}

TEST(BundleAgainstCeres, SameOptimumOnStereoProblems) {
  for (uint64_t seed = 1; seed <= 3; ++seed) ExpectSameOptimum({.stereo = 1, .seed = seed});
}

TEST(BundleAgainstCeres, SameOptimumOnMixedProblemsWithOutliers) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    // With fewer sightings, an outlier can move a point's optimum to infinity, where neither
    // converges.
    ExpectSameOptimum(
        {.points = 150, .min_track = 4, .stereo = 0.5, .outliers = 0.05, .seed = seed});
  }
}

TEST(BundleAgainstCeres, SameOptimumWhenSomeAreTrustedLess) {
  BundleProblem problem =
      MakeBundleProblem({.points = 150, .min_track = 4, .outliers = 0.05, .seed = 4});
  for (BundleObservation& o : problem.observations) o.trust = 0.05 + 0.19 * (o.point % 6);
  BundleProblem ours = problem, theirs = problem;
  const BundleReport report = AdjustBundle(ours, kToTheEnd);
  const ceres::Solver::Summary summary = AdjustWithCeres(theirs, kToTheEnd);
  EXPECT_NEAR(report.initial_cost, summary.initial_cost, 1e-9 * summary.initial_cost);
  EXPECT_NEAR(report.final_cost, summary.final_cost, 1e-6 * summary.final_cost);
}

// Start near the optimum, since this loss has several.
TEST(BundleAgainstCeres, SameOptimumWithARedescendingLoss) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    BundleProblem problem =
        MakeBundleProblem({.points = 150, .min_track = 4, .outliers = 0.05, .seed = seed});
    AdjustBundle(problem, kToTheEnd);
    BundleSettings settings = kToTheEnd;
    settings.redescending = true;
    BundleProblem ours = problem, theirs = problem;
    const BundleReport report = AdjustBundle(ours, settings);
    const ceres::Solver::Summary summary = AdjustWithCeres(theirs, settings);
    EXPECT_NEAR(report.initial_cost, summary.initial_cost, 1e-9 * summary.initial_cost);
    EXPECT_NEAR(report.final_cost, summary.final_cost, 1e-6 * summary.final_cost);
    EXPECT_LT(report.final_cost, report.initial_cost);
  }
}

TEST(BundleAgainstCeres, SameOptimumNearAPlane) {
  ExpectSameOptimum({.scene = BundleScene::kWall, .stereo = 0, .seed = 11});
  ExpectSameOptimum({.scene = BundleScene::kWall, .stereo = 0.5, .outliers = 0.05, .seed = 12});
}

TEST(BundleAgainstCeres, SameOptimumWithFewPoints) {
  ExpectSameOptimum({.free_cameras = 2, .points = 12, .max_track = 4, .stereo = 0, .seed = 13});
  ExpectSameOptimum({.free_cameras = 3, .points = 8, .max_track = 5, .stereo = 1, .seed = 14});
}

TEST(BundleAgainstCeres, SameOptimumWhenTheCameraOnlyTurnsAndPointsAreFar) {
  ExpectSameOptimum(
      {.scene = BundleScene::kTurning, .points = 120, .stereo = 1, .noise_px = 0.2, .seed = 15});
}

TEST(BundleAgainstCeres, SameOptimumAfterALoopWithTheReducedSystemSparse) {
  const BundleProblemOptions options{.scene = BundleScene::kRing,
                                     .fixed_cameras = 1,
                                     .free_cameras = 110,
                                     .points = 1200,
                                     .path_length = 40,
                                     .min_track = 3,
                                     .stereo = 0.5,
                                     .seed = 16};
  const BundleLayout layout = LayOut(MakeBundleProblem(options), kToTheEnd);
  ASSERT_TRUE(SchurSolver(layout, ReducedFactor::kFastest).sparse());
  ASSERT_GT(static_cast<int>(layout.free_cameras.size()), kToTheEnd.sparse_above);
  ExpectSameOptimum(options);
}

TEST(BundleAgainstCeres, NoWorseThanCeresWhenOneEyeOnlyTurns) {
  // Depths and positions are hardly observable: both creep along a flat valley without converging.
  const BundleProblem problem =
      MakeBundleProblem({.scene = BundleScene::kTurning, .stereo = 0, .noise_px = 0.2, .seed = 16});
  BundleProblem ours = problem, theirs = problem;
  const BundleReport report = AdjustBundle(ours, {.max_iterations = 50});
  CeresBundleOptions as_long;
  as_long.max_iterations = 50;
  EXPECT_LE(report.final_cost, AdjustWithCeres(theirs, {}, as_long).final_cost);
}

TEST(BundleAgainstCeres, SameOptimumWithoutAFixedCamera) {
  ExpectSameOptimum({.fixed_cameras = 0, .stereo = 0, .seed = 16});
  ExpectSameOptimum({.fixed_cameras = 0, .stereo = 1, .seed = 17});
}

TEST(BundleAgainstCeres, SameOptimumWithOneFixedCameraAndUnknownScale) {
  ExpectSameOptimum({.fixed_cameras = 1, .free_cameras = 9, .stereo = 0, .seed = 18});
}

TEST(BundleAgainstCeres, SameOptimumWhenACameraSeesAPointTwice) {
  BundleProblem problem = MakeBundleProblem({.free_cameras = 4, .points = 60, .seed = 20});
  const size_t count = problem.observations.size();
  for (size_t i = 0; i < count; i += 3) {
    problem.observations.push_back(problem.observations[i]);
    problem.observations.back().pixel += Eigen::Vector3d(1, -2, 1);
  }
  BundleProblem ours = problem, theirs = problem;
  const BundleReport report = AdjustBundle(ours, kToTheEnd);
  const double expected = AdjustWithCeres(theirs, kToTheEnd).final_cost;
  EXPECT_NEAR(report.final_cost, expected, 1e-6 * expected);
  // A wrong Hessian block would still converge, but slowly.
  EXPECT_LT(report.iterations, 60);
}

TEST(BundleAgainstCeres, SameOptimumWithASparseReducedSystem) {
  const BundleProblem problem = MakeBundleProblem({.free_cameras = 60,
                                                   .points = 600,
                                                   .path_length = 60,
                                                   .max_track = 4,
                                                   .stereo = 1,
                                                   .seed = 20});
  BundleProblem ours = problem, theirs = problem;
  BundleSettings settings = kToTheEnd;
  settings.sparse_above = 10;
  const double expected = AdjustWithCeres(theirs, settings).final_cost;
  EXPECT_NEAR(AdjustBundle(ours, settings).final_cost, expected, 1e-6 * expected);
}

TEST(BundleAgainstCeres, SameOptimumWhenOnlyPointsMove) {
  ExpectSameOptimum({.fixed_cameras = 8, .free_cameras = 0, .stereo = 0, .seed = 19});
}

}  // namespace
}  // namespace alidade::bundle_ceres_test
