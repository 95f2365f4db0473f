#include "alidade/calibration/lens_adjustment.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "alidade/base/error.h"

namespace alidade::lens_adjustment_test {
namespace {

enum class Motion { kRound, kSideways, kForward };

struct World {
  RadialLens lens;
  std::vector<LensWindow> windows;
};

// Points in a box of 4 x 3 x 3, about 5 ahead; cameras on an arc that look at its center, or on a
// straight line without rotation.
World MakeWorld(Motion motion, double fov, double k1, double noise_px, int seed, int windows = 1,
                double outliers = 0) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> even(-1, 1);
  World world;
  world.lens = {320 / std::tan(fov * M_PI / 360), k1, 0, {319.5, 239.5}};
  for (int w = 0; w < windows; ++w) {
    LensWindow window;
    for (int i = 0; i < 12; ++i) {
      const double s = i / 11.0 - 0.5;
      Se3 T_world_camera;
      if (motion == Motion::kRound) {
        const double turn = 0.8 * s;
        T_world_camera = Se3::Exp(
            (Eigen::Matrix<double, 6, 1>() << 0, 0, 0, 0.2 * s * s + 0.05 * w, -turn, 0.1 * s)
                .finished());
        T_world_camera.t = {5 * std::sin(turn), 0.3 * std::cos(5 * s), 5 - 5 * std::cos(turn)};
      } else if (motion == Motion::kSideways) {
        T_world_camera.t = {2 * s, 0.2 * s, 0};
      } else {
        T_world_camera.t = {0, 0, 2 * s};
      }
      window.T_camera_world.push_back(T_world_camera.Inverse());
    }
    for (int n = 0; n < 150; ++n) {
      const Eigen::Vector3d p(2.2 * even(random), 1.6 * even(random), 5 + 1.5 * even(random));
      std::vector<LensObservation> seen;
      for (int i = 0; i < 12; ++i) {
        const Eigen::Vector3d q = window.T_camera_world[static_cast<size_t>(i)] * p;
        const Eigen::Vector2d x = q.head<2>() / q.z();
        const double r2 = x.squaredNorm();
        Eigen::Vector2d pixel = world.lens.centre + world.lens.focal * (1 + world.lens.k1 * r2) * x;
        if (!(pixel.x() > 0 && pixel.x() < 640 && pixel.y() > 0 && pixel.y() < 480)) continue;
        pixel += noise_px * Eigen::Vector2d(gauss(random), gauss(random));
        if (even(random) < 2 * outliers - 1)
          pixel += 12 * Eigen::Vector2d(even(random), even(random));
        seen.push_back({i, static_cast<int>(window.points.size()), pixel, 1});
      }
      if (seen.size() < 3) continue;
      window.observations.insert(window.observations.end(), seen.begin(), seen.end());
      window.points.push_back(p);
    }
    world.windows.push_back(window);
  }
  return world;
}

// A map built with a wrong lens has more than noise errors.
void Disturb(std::vector<LensWindow>& windows, double by, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> gauss(0, by);
  for (LensWindow& window : windows) {
    for (Se3& T : window.T_camera_world) {
      Eigen::Matrix<double, 6, 1> step;
      for (double& s : step) s = gauss(random);
      T = Se3::Exp(step) * T;
    }
    for (Eigen::Vector3d& p : window.points)
      p += Eigen::Vector3d(gauss(random), gauss(random), 3 * gauss(random));
  }
}

TEST(LensAdjustment, FindsAnyLensFromAnyStartWithoutNoise) {
  for (double fov : {40.0, 60.0, 90.0}) {
    for (double k1 : {-0.2, 0.0, 0.1}) {
      for (double start : {45.0, 66.0, 85.0}) {
        World world = MakeWorld(Motion::kRound, fov, k1, 0, 3);
        Disturb(world.windows, 0.01, 5);
        const RadialLens at{320 / std::tan(start * M_PI / 360), 0, 0, world.lens.centre};
        // The prior is practically off: this tests convergence only.
        const LensAdjustment found = AdjustLens(
            world.windows, at,
            {.max_iterations = 100, .focal_sigma = 10, .k1_sigma = 10, .k2_sigma = 0, .bound = 20});
        EXPECT_NEAR(found.lens.focal / world.lens.focal, 1, 1e-3)
            << fov << " from " << start << " k1 " << k1;
        EXPECT_NEAR(found.lens.k1, k1, 2e-3) << fov << " from " << start;
      }
    }
  }
}

// The same world, observed with a rolling shutter by moving cameras.
void Roll(World& world, const Eigen::Vector2d& readout) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> even(-1, 1);
  world.lens.readout = readout;
  for (LensWindow& window : world.windows) {
    for (size_t i = 0; i < window.T_camera_world.size(); ++i) {
      window.motions.push_back((Vector6d() << 0.5 * even(random), 0.5 * even(random),
                                0.5 * even(random), even(random), even(random), even(random))
                                   .finished());
    }
    for (LensObservation& o : window.observations) {
      const auto camera = static_cast<size_t>(o.camera);
      const Eigen::Vector3d p =
          window.T_camera_world[camera] * window.points[static_cast<size_t>(o.point)];
      // Fixed-point iteration: the readout time depends on the position.
      for (int i = 0; i < 20; ++i) {
        o.read = {o.pixel.x() / 640 - 0.5, o.pixel.y() / 480 - 0.5};
        const Eigen::Vector3d q = Se3::Exp(readout.dot(o.read) * window.motions[camera]) * p;
        const Eigen::Vector2d x = q.head<2>() / q.z();
        o.pixel = world.lens.centre + world.lens.focal * (1 + world.lens.k1 * x.squaredNorm()) * x;
      }
    }
  }
}

TEST(LensAdjustment, FindsHowLongARollingShutterTakes) {
  for (const Eigen::Vector2d& readout : {Eigen::Vector2d(0, 0.03), Eigen::Vector2d(-0.015, 0)}) {
    World world = MakeWorld(Motion::kRound, 60, -0.1, 0, 3, 2);
    Roll(world, readout);
    Disturb(world.windows, 0.01, 5);
    LensAdjustmentSettings settings{.max_iterations = 100, .k2_sigma = 0, .bound = 20};
    settings.readout_sigma = {1, 1};
    const RadialLens at{320 / std::tan(66 * M_PI / 360), 0, 0, world.lens.centre};
    std::vector<LensWindow> windows = world.windows;
    const LensAdjustment found = AdjustLens(windows, at, settings);
    EXPECT_LT((found.lens.readout - readout).norm(), 2e-4);
    EXPECT_NEAR(found.lens.focal / world.lens.focal, 1, 1e-3);
    EXPECT_GT(found.covariance(5, 5), 0);

    // With a known lens only the readout time changes.
    settings.hold_focal = true;
    settings.k1_sigma = 0;
    windows = world.windows;
    RadialLens known = world.lens;
    known.readout.setZero();
    const LensAdjustment held = AdjustLens(windows, known, settings);
    EXPECT_LT((held.lens.readout - readout).norm(), 2e-4);
    EXPECT_EQ(held.lens.focal, world.lens.focal);
    EXPECT_EQ(held.lens.k1, world.lens.k1);
    EXPECT_EQ(held.covariance(0, 0), 0);
  }
}

TEST(LensAdjustment, MotionsMustBeThoseOfTheCameras) {
  World world = MakeWorld(Motion::kRound, 60, 0, 0, 3);
  world.windows[0].motions.resize(3, Vector6d::Zero());
  EXPECT_THROW(AdjustLens(world.windows, world.lens), Error);
}

struct CeresResidual {
  LensObservation o;
  Eigen::Vector2d centre;
  template <typename T>
  bool operator()(const T* turn, const T* shift, const T* point, const T* lens, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(turn, point, p);
    for (int i = 0; i < 3; ++i) p[i] += shift[i];
    const T x = p[0] / p[2], y = p[1] / p[2], r2 = x * x + y * y;
    const T scale = ceres::exp(lens[0]) * (1.0 + lens[1] * r2 + lens[2] * r2 * r2);
    residual[0] = scale * x + centre.x() - o.pixel.x();
    residual[1] = scale * y + centre.y() - o.pixel.y();
    return true;
  }
};

struct CeresPrior {
  Eigen::Vector3d mean, sigma;
  double noise;
  template <typename T>
  bool operator()(const T* lens, T* residual) const {
    for (int i = 0; i < 3; ++i) residual[i] = noise * (lens[i] - mean[i]) / sigma[i];
    return true;
  }
};

// Minimum and covariance agree with Ceres for unit weights.
TEST(LensAdjustment, AgreesWithCeres) {
  World world = MakeWorld(Motion::kRound, 60, -0.15, 0.5, 7, 2);
  Disturb(world.windows, 0.005, 8);
  const RadialLens at{500, 0, 0, world.lens.centre};
  const LensAdjustmentSettings settings{.max_iterations = 100,
                                        .min_relative_decrease = 1e-12,
                                        .min_lens_step = 1e-8,
                                        .inflation = 1,
                                        .bound = 1e4};
  std::vector<LensWindow> windows = world.windows;
  const LensAdjustment found = AdjustLens(windows, at, settings);
  EXPECT_TRUE(found.converged);
  // Remaining after the fit: a point takes 3 of about 20 residuals.
  EXPECT_NEAR(found.noise, 0.5 * std::sqrt(17.0 / 20), 0.02);

  ceres::Problem problem;
  double lens[3] = {std::log(at.focal), 0, 0};
  struct Pose {
    double turn[3], shift[3];
  };
  std::vector<std::vector<Pose>> poses(2);
  for (size_t w = 0; w < 2; ++w) {
    LensWindow& window = world.windows[w];
    for (const Se3& T : window.T_camera_world) {
      Pose pose;
      ceres::RotationMatrixToAngleAxis(T.R.data(), pose.turn);
      std::copy(T.t.data(), T.t.data() + 3, pose.shift);
      poses[w].push_back(pose);
    }
    for (const LensObservation& o : window.observations) {
      Pose& pose = poses[w][static_cast<size_t>(o.camera)];
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CeresResidual, 2, 3, 3, 3, 3>(
                                   new CeresResidual{o, world.lens.centre}),
                               nullptr, pose.turn, pose.shift,
                               window.points[static_cast<size_t>(o.point)].data(), lens);
    }
    // Gauge: the first camera, and the distance of the last one.
    problem.SetParameterBlockConstant(poses[w][0].turn);
    problem.SetParameterBlockConstant(poses[w][0].shift);
    problem.SetManifold(poses[w][11].shift, new ceres::SubsetManifold(3, {0}));
  }
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CeresPrior, 3, 3>(new CeresPrior{
                               {lens[0], 0, 0},
                               {settings.focal_sigma, settings.k1_sigma, settings.k2_sigma},
                               found.noise}),
                           nullptr, lens);
  ceres::Solver::Options options;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_NEAR(found.lens.focal, std::exp(lens[0]), 1e-3);
  EXPECT_NEAR(found.lens.k1, lens[1], 1e-5);
  EXPECT_NEAR(found.lens.k2, lens[2], 1e-5);

  ceres::Covariance covariance({});
  ASSERT_TRUE(covariance.Compute(std::vector<std::pair<const double*, const double*>>{{lens, lens}},
                                 &problem));
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> expected;
  covariance.GetCovarianceBlock(lens, lens, expected.data());
  expected *= found.noise * found.noise;
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found.covariance(i, i) / expected(i, i), 1, 0.01) << i;
}

// Errors agree with the reported covariance over 30 worlds.
TEST(LensAdjustment, SaysHowFarItIsToBeTrusted) {
  double normalised = 0;
  for (int seed = 0; seed < 30; ++seed) {
    World world = MakeWorld(Motion::kRound, 62, -0.1, 0.4, 100 + seed);
    Disturb(world.windows, 0.005, seed);
    const RadialLens at{320 / std::tan(66 * M_PI / 360), 0, 0, world.lens.centre};
    const LensAdjustment found = AdjustLens(world.windows, at, {.inflation = 1});
    const double off = std::log(found.lens.focal / world.lens.focal);
    EXPECT_LT(std::abs(off), 0.03) << seed;
    normalised += off * off / found.covariance(0, 0) / 30;
  }
  // chi² with 30 degrees of freedom divided by 30: 98 % in 0.5 to 1.6. The loss also down-weights
  // good observations.
  EXPECT_GT(normalised, 0.4);
  EXPECT_LT(normalised, 1.7);
}

TEST(LensAdjustment, IsNotMovedByMatchesThatAreNoPoints) {
  World world = MakeWorld(Motion::kRound, 62, 0, 0.4, 11, 1, 0.08);
  Disturb(world.windows, 0.005, 12);
  const RadialLens at{320 / std::tan(66 * M_PI / 360), 0, 0, world.lens.centre};
  const LensAdjustment found = AdjustLens(world.windows, at);
  EXPECT_LT(std::abs(std::log(found.lens.focal / world.lens.focal)),
            4 * std::sqrt(found.covariance(0, 0)));
}

// Without rotation the focal length is unobservable: any other one with adapted depths explains the
// observations.
TEST(LensAdjustment, KnowsWhatItCannotKnow) {
  for (Motion motion : {Motion::kSideways, Motion::kForward}) {
    World world = MakeWorld(motion, 60, 0, 0.4, 21);
    const RadialLens at{320 / std::tan(66 * M_PI / 360), 0, 0, world.lens.centre};
    const LensAdjustment found = AdjustLens(world.windows, at);
    EXPECT_GT(std::sqrt(found.covariance(0, 0)), 0.1) << static_cast<int>(motion);
  }
}

TEST(LensAdjustment, NothingSeenLeavesThePrior) {
  std::vector<LensWindow> none;
  const LensAdjustment found = AdjustLens(none, {500, 0, 0, {319.5, 239.5}});
  EXPECT_EQ(found.observations, 0);
  EXPECT_NEAR(found.lens.focal, 500, 1e-9);
  EXPECT_NEAR(std::sqrt(found.covariance(0, 0)), LensAdjustmentSettings().focal_sigma, 1e-9);
}

}  // namespace
}  // namespace alidade::lens_adjustment_test
