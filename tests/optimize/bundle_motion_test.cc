// Bundle adjustment with an inertial sensor: against the truth, and against Ceres.
#include <gtest/gtest.h>

#include "alidade/base/error.h"
#include "bundle_errors.h"
#include "ceres_bundle.h"
#include "motion_problem.h"

namespace alidade::bundle_motion_test {
namespace {

constexpr BundleSettings kToTheEnd{.max_iterations = 400, .min_relative_decrease = 1e-15};

// All lengths from the first camera, the only one held, grow by `factor`.
void Grow(BundleProblem& problem, double factor) {
  const Eigen::Vector3d origin = problem.T_camera_world[0].Inverse().t;
  for (Eigen::Vector3d& p : problem.points) p = origin + factor * (p - origin);
  for (Se3& T : problem.T_camera_world) {
    const Eigen::Vector3d centre = origin + factor * (T.Inverse().t - origin);
    T.t = -(T.R * centre);
  }
}

double WorstPosition(const BundleProblem& problem, double path_length) {
  double worst = 0;
  const auto cameras = static_cast<double>(problem.fixed.size());
  for (size_t i = 0; i < problem.fixed.size(); ++i) {
    const Se3 truth =
        BundleCameraAt(BundleScene::kRing, path_length, (static_cast<double>(i) + 0.5) / cameras);
    worst = std::max(worst, (problem.T_camera_world[i].Inverse().t - truth.Inverse().t).norm());
  }
  return worst;
}

TEST(BundleMotion, TellsTheScaleOfOneCamera) {
  MotionProblemOptions options;
  options.bundle.noise_px = 1e-6;
  options.noise = {1e-6, 1e-5, 1e-6, 1e-5};
  options.bias = {{0.02, -0.01, 0.03}, {0.1, -0.15, 0.05}};
  BundleProblem problem = MakeMotionProblem(options);
  Grow(problem, 0.8);
  BundleProblem without = problem;
  without.motion = {};
  AdjustBundle(without, kToTheEnd);
  EXPECT_GT(WorstPosition(without, options.bundle.path_length), 0.1);
  const BundleReport report = AdjustBundle(problem, kToTheEnd);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(WorstPosition(problem, options.bundle.path_length), 2e-3);
  const MotionPath path{options.bundle.path_length, options.seconds};
  for (const BundleMotionState& state : problem.motion.states) {
    const double time = options.seconds * (state.camera + 0.5) / 21;
    EXPECT_LT((state.velocity - path.VelocityAt(time)).norm(), 5e-3);
    EXPECT_LT((state.accel_bias - options.bias.accel).norm(), 0.01);
  }
}

void ExpectSameOptimum(const MotionProblemOptions& options, const BundleSettings& settings) {
  const BundleProblem problem = MakeMotionProblem(options);
  BundleProblem ours = problem, theirs = problem;
  const BundleReport report = AdjustBundle(ours, settings);
  const ceres::Solver::Summary summary = AdjustWithCeres(theirs, settings);
  EXPECT_NEAR(report.initial_cost, summary.initial_cost, 1e-9 * summary.initial_cost);
  EXPECT_NEAR(report.final_cost, summary.final_cost, 1e-6 * summary.final_cost)
      << summary.BriefReport() << " ours " << report.iterations;
  for (size_t i = 0; i < ours.fixed.size(); ++i) {
    const Se3 between = ours.T_camera_world[i] * theirs.T_camera_world[i].Inverse();
    EXPECT_LT(between.Log().norm(), 1e-5) << i;
  }
}

TEST(BundleMotion, HasTheOptimumThatCeresFinds) {
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    MotionProblemOptions options;
    options.bundle.seed = seed;
    options.bias = {{0.02, -0.01, 0.03}, {0.1, -0.15, 0.05}};
    ExpectSameOptimum(options, kToTheEnd);
    options.bundle.stereo = 1;
    options.bundle.fixed_cameras = 3;
    ExpectSameOptimum(options, kToTheEnd);
  }
}

TEST(BundleMotion, HasTheSameOptimumFactoredSparse) {
  MotionProblemOptions options;
  options.bundle.free_cameras = 30;
  options.bundle.min_track = 3;
  options.bundle.max_track = 4;
  BundleSettings sparse = kToTheEnd;
  sparse.sparse_above = 0;
  ExpectSameOptimum(options, sparse);
}

TEST(BundleMotion, RefusesIndicesOutOfRange) {
  const BundleProblem good = MakeMotionProblem({});
  BundleProblem problem = good;
  problem.motion.links[3].to = 21;
  EXPECT_THROW(AdjustBundle(problem), Error);
  problem = good;
  problem.motion.states[2].camera = -1;
  EXPECT_THROW(AdjustBundle(problem), Error);
  problem = good;
  problem.motion.links[3].covariance.setZero();
  EXPECT_THROW(AdjustBundle(problem), Error);
}

}  // namespace
}  // namespace alidade::bundle_motion_test
