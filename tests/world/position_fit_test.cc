// Trajectories against positions of a known similarity, with noise, outliers and other clocks.
#include "alidade/run/world/position_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "alidade/base/random.h"

namespace alidade::position_fit_test {
namespace {

using testing::HasSubstr;

const Sim3 kTruth{3.7, ExpSo3({0.4, -1.1, 2.0}), {400, -250, 30}};
const Eigen::Vector3d kDown = kTruth.R.transpose() * -Eigen::Vector3d::UnitZ();

Eigen::Vector3d Wandering(double t) {
  return {1.5 * std::sin(0.5 * t), std::cos(0.8 * t) + 0.1 * t, 0.2 * std::sin(1.3 * t)};
}
Eigen::Vector3d Straight(double t) { return {0.3 * t + 0.3 * std::sin(t), 0, 0}; }

struct Problem {
  Trajectory trajectory;  // 30 s at 20 Hz
  std::vector<TimedPosition> positions;
};

struct Errors {
  double sigma = 0.02;  // meters
  double outliers = 0;
  double offset = 0;  // seconds
  double step = 0.5;  // seconds between positions
};

Problem Make(const std::function<Eigen::Vector3d(double)>& path, const Errors& errors) {
  Problem problem;
  Random random(7);
  for (int i = 0; i <= 600; ++i) {
    const double t = 0.05 * i;
    problem.trajectory.push_back({t, {ExpSo3({0, 0.1 * t, 0}), path(t)}, ""});
  }
  for (double t = 0.13; t < 29.9; t += errors.step) {
    Eigen::Vector3d p = kTruth * path(t);
    for (int k = 0; k < 3; ++k) p[k] += errors.sigma * random.Gaussian();
    if (random.Uniform() < errors.outliers)
      for (int k = 0; k < 3; ++k) p[k] += random.Uniform(-8, 8);
    problem.positions.push_back({t + errors.offset, p});
  }
  return problem;
}

void ExpectTruth(const PositionFit& fit, double offset) {
  ASSERT_EQ(fit.why_not, "");
  EXPECT_NEAR(fit.T_positions_world.s / kTruth.s, 1, 4 * fit.scale_sigma);
  EXPECT_LT(fit.scale_sigma, 0.005);
  const Se3 found{fit.T_positions_world.R, {}}, truth{kTruth.R, {}};
  EXPECT_LT(RotationAngle(found, truth), 5 * fit.rotation_sigma);
  EXPECT_LT(fit.rotation_sigma, 0.02);
  EXPECT_NEAR(fit.time_offset, offset, 4 * fit.time_offset_sigma);
  EXPECT_LT(fit.time_offset_sigma, 0.02);
  EXPECT_LT((fit.T_positions_world.t - kTruth.t).norm(), 0.05);
}

TEST(PositionFit, FindsTheSimilarityAndTheClock) {
  for (const double offset : {0.0, 0.37, -3.3, 1.7e9}) {
    const Problem problem = Make(Wandering, {.offset = offset});
    ExpectTruth(FitPositions(problem.trajectory, problem.positions, {}), offset);
  }
}

TEST(PositionFit, LeavesOutAFifthOfOutliersAndTellsThem) {
  const Problem problem = Make(Wandering, {.outliers = 0.2, .offset = -0.9});
  const PositionFit fit = FitPositions(problem.trajectory, problem.positions, {});
  ExpectTruth(fit, -0.9);
  int wrong = 0, far = 0;
  for (size_t i = 0; i < fit.residuals.size(); ++i) {
    const bool outlier = (fit.positions[i] - kTruth * Wandering(fit.times[i])).norm() > 0.3;
    far += outlier;
    wrong += outlier == fit.used[i];
  }
  EXPECT_GT(far, 5);
  EXPECT_LE(wrong, 1);
  EXPECT_NEAR(fit.Quantile(0.5), 0.02 * 1.54, 0.01);  // median length of three errors
  EXPECT_LT(fit.Quantile(1), 0.1);
}

TEST(PositionFit, AGivenOffsetAndAntennaAreUsed) {
  Problem problem = Make(Wandering, {.offset = 0.4});
  const Eigen::Vector3d antenna(0.3, -0.5, 0.1);
  for (TimedPosition& position : problem.positions) {
    const double t = position.time - 0.4;
    position.p += kTruth.R * (ExpSo3({0, 0.1 * t, 0}) * antenna);
  }
  PositionFitSettings settings;
  settings.time_offset = 0.4;
  settings.antenna = antenna;
  const PositionFit fit = FitPositions(problem.trajectory, problem.positions, settings);
  ExpectTruth(fit, 0.4);
  EXPECT_EQ(fit.time_offset_sigma, 0);
  EXPECT_LT(fit.Quantile(0.5), 0.05);
}

TEST(PositionFit, AStraightPathIsRefusedUnlessGravityIsKnown) {
  const Problem problem = Make(Straight, {.offset = 0.2});
  const PositionFit refused = FitPositions(problem.trajectory, problem.positions, {});
  EXPECT_THAT(refused.why_not, HasSubstr("rotation is not observable"));
  EXPECT_THAT(refused.why_not, HasSubstr("degrees"));
  PositionFitSettings settings;
  settings.down = kDown;
  const PositionFit fit = FitPositions(problem.trajectory, problem.positions, settings);
  ASSERT_EQ(fit.why_not, "");
  EXPECT_TRUE(fit.by_gravity);
  EXPECT_LT(RotationAngle(Se3{fit.T_positions_world.R, {}}, Se3{kTruth.R, {}}), 0.03);
  EXPECT_NEAR(fit.T_positions_world.s / kTruth.s, 1, 0.01);
}

TEST(PositionFit, WhatCannotBeIsRefusedWithFigures) {
  const auto reason = [](const Problem& problem) {
    return FitPositions(problem.trajectory, problem.positions, {}).why_not;
  };
  EXPECT_THAT(reason(Make(Wandering, {.step = 8})), HasSubstr("too few positions: "));
  EXPECT_THAT(reason(Make(Wandering, {.sigma = 4})), HasSubstr("scale is not observable"));
  Problem other = Make(Wandering, {});
  Random random(2);
  for (TimedPosition& position : other.positions)
    position.p = {random.Uniform(-9, 9), random.Uniform(-9, 9), random.Uniform(-9, 9)};
  EXPECT_NE(reason(other), "");
}

TEST(PositionFit, LengthsOfDepthCamerasAreNotScaled) {
  Problem problem = Make(Wandering, {});
  for (StampedPose& pose : problem.trajectory) pose.T_world_camera.t *= kTruth.s;
  PositionFitSettings settings;
  settings.meters = true;
  const PositionFit fit = FitPositions(problem.trajectory, problem.positions, settings);
  ASSERT_EQ(fit.why_not, "");
  EXPECT_EQ(fit.T_positions_world.s, 1);
  EXPECT_LT((fit.T_positions_world.t - kTruth.t).norm(), 0.05);
}

}  // namespace
}  // namespace alidade::position_fit_test
