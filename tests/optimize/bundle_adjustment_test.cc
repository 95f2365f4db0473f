#include "alidade/optimize/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <limits>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "optimize/bundle_errors.h"
#include "problems/bundle_problem.h"

namespace alidade::bundle_adjustment_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(AdjustBundle, ReturnsToTruthWithoutNoise) {
  BundleProblemOptions options{.stereo = 1, .noise_px = 0, .seed = 21};
  BundleProblem problem = MakeBundleProblem(options);
  const BundleReport report =
      AdjustBundle(problem, {.max_iterations = 50, .min_relative_decrease = 1e-12});
  EXPECT_LT(report.final_cost, 1e-12 * report.initial_cost);
  options.point_error = options.camera_error = options.rotation_error = 0;
  const BundleProblem truth = MakeBundleProblem(options);
  EXPECT_LT(LargestPointError(problem, truth), 1e-5);
  for (size_t i = 0; i < truth.T_camera_world.size(); ++i) {
    EXPECT_LT(RotationAngle(problem.T_camera_world[i], truth.T_camera_world[i]), 1e-7);
  }
}

TEST(AdjustBundle, CostNeverRisesHoweverFarTheStart) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const BundleProblem start = MakeBundleProblem({.free_cameras = 6,
                                                   .points = 120,
                                                   .stereo = seed % 2 * 0.5,
                                                   .outliers = 0.1,
                                                   .outlier_px = 300,
                                                   .point_error = 1.5,
                                                   .camera_error = 0.3,
                                                   .rotation_error = 0.2,
                                                   .seed = seed});
    double before = std::numeric_limits<double>::infinity();
    for (int iterations = 0; iterations < 25; ++iterations) {
      BundleProblem problem = start;
      const BundleReport report =
          AdjustBundle(problem, {.max_iterations = iterations, .min_relative_decrease = 0});
      EXPECT_LE(report.final_cost, before);
      EXPECT_LE(report.final_cost, report.initial_cost);
      before = report.final_cost;
    }
    EXPECT_LT(before, 1e9);
  }
}

TEST(AdjustBundle, ReportsTheCostOfWhatItReturns) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    BundleProblem problem = MakeBundleProblem({.outliers = 0.05, .seed = seed});
    const double before = CostOf(problem);
    const BundleReport report = AdjustBundle(problem);
    EXPECT_NEAR(report.initial_cost, before, 1e-9 * before);
    EXPECT_NEAR(report.final_cost, CostOf(problem), 1e-9 * before);
    EXPECT_LT(report.final_cost, 0.5 * report.initial_cost);
    EXPECT_LE(report.iterations, 10);
  }
}

TEST(AdjustBundle, GivesTheSameBitsWithAnyNumberOfThreads) {
  for (const int sparse_above : {100, 10}) {
    const BundleProblem start = MakeBundleProblem({.free_cameras = 80,
                                                   .points = 1500,
                                                   .path_length = 80,
                                                   .max_track = 5,
                                                   .outliers = 0.05,
                                                   .seed = 22});
    ASSERT_GT(start.observations.size(), 4000u);  // enough for several chunks
    BundleSettings settings;
    settings.sparse_above = sparse_above;
    BundleProblem one = start;
    SetThreadCount(1);
    AdjustBundle(one, settings);
    for (const int threads : {2, 3}) {
      BundleProblem several = start;
      SetThreadCount(threads);
      AdjustBundle(several, settings);
      EXPECT_TRUE(SameBits(one, several)) << threads;
    }
    SetThreadCount(0);
    EXPECT_FALSE(SameBits(one, start));
  }
}

// As after a loop closure: a small error everywhere, varying smoothly around the loop.
TEST(AdjustBundle, AMapBentAllAlongIsStraightenedWithLittleDamping) {
  BundleProblem bent = MakeBundleProblem({.scene = BundleScene::kRing,
                                          .fixed_cameras = 2,
                                          .free_cameras = 150,
                                          .points = 4000,
                                          .path_length = 40,
                                          .min_track = 3,
                                          .stereo = 0,
                                          .point_error = 0,
                                          .camera_error = 0,
                                          .rotation_error = 0,
                                          .seed = 31});
  const auto bend = [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    // Angle along the ring; the first cameras are at 0.
    const double turn = std::atan2(p.x(), p.z());
    return (1 + 0.03 * (1 - std::cos(turn))) * p + Eigen::Vector3d(0, 0.15 * std::sin(2 * turn), 0);
  };
  for (Eigen::Vector3d& p : bent.points) p = bend(p);
  for (size_t i = 2; i < bent.T_camera_world.size(); ++i) {
    Se3& T = bent.T_camera_world[i];
    T.t = -(T.R * bend(T.Inverse().t));
  }
  BundleProblem best = bent, quick = bent;
  AdjustBundle(best,
               {.max_iterations = 100, .min_relative_decrease = 1e-10, .initial_lambda = 1e-6});
  AdjustBundle(quick,
               {.max_iterations = 10, .min_relative_decrease = 1e-4, .initial_lambda = 1e-6});
  const double bent_by = LargestCameraError(bent, best);
  EXPECT_GT(bent_by, 0.3);
  EXPECT_LT(LargestCameraError(quick, best), 0.05 * bent_by);
}

TEST(AdjustBundle, SparseAndDenseReducedSystemsGiveTheSameSteps) {
  const BundleProblem start = MakeBundleProblem({.free_cameras = 80,
                                                 .points = 800,
                                                 .path_length = 80,
                                                 .max_track = 5,
                                                 .outliers = 0.05,
                                                 .seed = 23});
  BundleProblem dense = start, sparse = start;
  const BundleReport a = AdjustBundle(dense, {.sparse_above = 100});
  const BundleReport b = AdjustBundle(sparse, {.sparse_above = 10});
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_NEAR(a.final_cost, b.final_cost, 1e-9 * a.final_cost);
  EXPECT_LT(LargestPointError(dense, sparse), 1e-6);
}

TEST(AdjustBundle, StopsWhenTold) {
  const BundleProblem start = MakeBundleProblem({.seed = 24});
  BundleProblem problem = start;
  const std::atomic<bool> stop{true};
  const BundleReport report = AdjustBundle(problem, {}, &stop);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.final_cost, report.initial_cost);
  EXPECT_TRUE(SameBits(problem, start));
  const std::atomic<bool> go_on{false};
  EXPECT_GT(AdjustBundle(problem, {}, &go_on).iterations, 0);
}

TEST(AdjustBundle, SaysWhetherItConverged) {
  const BundleProblem start = MakeBundleProblem({.stereo = 1, .seed = 25});
  BundleProblem problem = start;
  EXPECT_FALSE(AdjustBundle(problem, {.max_iterations = 1}).converged);
  problem = start;
  EXPECT_TRUE(AdjustBundle(problem, {.max_iterations = 50}).converged);
  EXPECT_TRUE(AdjustBundle(problem, {.max_iterations = 50}).converged);  // already converged
}

TEST(AdjustBundle, EmptyProblemsStayAsTheyAre) {
  BundleProblem nothing;
  nothing.camera = MakeProblemCamera();
  EXPECT_EQ(AdjustBundle(nothing).final_cost, 0);

  BundleProblem unseen = MakeBundleProblem({.seed = 26});
  unseen.observations.clear();
  const BundleProblem before = unseen;
  const BundleReport report = AdjustBundle(unseen);
  EXPECT_EQ(report.initial_cost, 0);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_TRUE(SameBits(unseen, before));
}

TEST(AdjustBundle, WhatIsFixedOrUnseenStaysToTheBit) {
  BundleProblem problem = MakeBundleProblem({.seed = 27});
  problem.T_camera_world.push_back(Se3::Exp(Vector6d::Constant(0.3)));
  problem.fixed.push_back(0);
  problem.points.emplace_back(1, 2, 3);
  const BundleProblem before = problem;
  AdjustBundle(problem);
  for (size_t i = 0; i < problem.fixed.size(); ++i) {
    const bool same = problem.T_camera_world[i].R == before.T_camera_world[i].R &&
                      problem.T_camera_world[i].t == before.T_camera_world[i].t;
    EXPECT_EQ(same, problem.fixed[i] || i + 1 == problem.fixed.size()) << i;
  }
  EXPECT_EQ(problem.points.back(), Eigen::Vector3d(1, 2, 3));
}

TEST(AdjustBundle, RotationsStayOrthonormal) {
  BundleProblem problem = MakeBundleProblem({.rotation_error = 0.1, .seed = 28});
  AdjustBundle(problem, {.max_iterations = 30});
  for (const Se3& T : problem.T_camera_world) {
    EXPECT_LT((T.R * T.R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-13);
  }
}

TEST(AdjustBundle, TheOrderOfObservationsDoesNotMatter) {
  const BundleProblem start = MakeBundleProblem({.seed = 29});
  BundleProblem sorted = start, shuffled = start;
  Random random(3);
  for (size_t i = shuffled.observations.size() - 1; i > 0; --i) {
    std::swap(shuffled.observations[i], shuffled.observations[random.Below(i + 1)]);
  }
  const BundleReport a = AdjustBundle(sorted), b = AdjustBundle(shuffled);
  EXPECT_NEAR(a.final_cost, b.final_cost, 1e-9 * a.final_cost);
  EXPECT_LT(LargestPointError(sorted, shuffled), 1e-6);
}

TEST(AdjustBundle, IndicesThatAreNotThereAreNamed) {
  BundleProblem problem = MakeBundleProblem({.seed = 34});
  problem.observations[3].camera = 99;
  EXPECT_THROW(AdjustBundle(problem), Error);
  problem = MakeBundleProblem({.seed = 34});
  problem.observations[3].point = -1;
  EXPECT_THROW(AdjustBundle(problem), Error);
  problem = MakeBundleProblem({.seed = 34});
  problem.fixed.pop_back();
  EXPECT_THROW(AdjustBundle(problem), Error);
}

TEST(AdjustBundle, SettingsThatCannotBeAreNamed) {
  const auto complaint = [](BundleSettings settings) -> std::string {
    try {
      settings.Check();
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  const auto names = [&](BundleSettings settings, const char* field) {
    return complaint(settings).find(field) == 0;
  };
  EXPECT_EQ(complaint({}), "");
  EXPECT_TRUE(names({.max_iterations = -1}, "max_iterations"));
  EXPECT_TRUE(names({.huber_mono = 0}, "huber_mono"));
  EXPECT_TRUE(names({.huber_stereo = kNaN}, "huber_stereo"));
  EXPECT_TRUE(names({.min_relative_decrease = -1}, "min_relative_decrease"));
  EXPECT_TRUE(names({.initial_lambda = 0}, "initial_lambda"));
  EXPECT_TRUE(names({.sparse_above = -1}, "sparse_above"));
}

TEST(ChiSquared, IsTheSquaredErrorInStandardDeviations) {
  const Camera camera = MakeProblemCamera();
  const Eigen::Vector3d p(0.3, -0.2, 2.0);
  BundleObservation o{.camera = 0, .point = 0, .pixel = ProjectStereo(camera, p)};
  o.pixel += Eigen::Vector3d(3, -4, 2);
  o.inv_sigma2 = 0.25;
  o.inv_sigma2_right = 0.5;
  // The error of the disparity u - u_right is 3 - 2.
  EXPECT_NEAR(ChiSquared(camera, {}, p, o), 0.25 * 25 + 0.5 * 1, 1e-10);
  o.trust = 0.1;  // does not affect chi²
  EXPECT_NEAR(ChiSquared(camera, {}, p, o), 0.25 * 25 + 0.5 * 1, 1e-10);
  o.pixel.z() = kNaN;
  EXPECT_NEAR(ChiSquared(camera, {}, p, o), 0.25 * 25, 1e-10);
}

}  // namespace
}  // namespace alidade::bundle_adjustment_test
