// Preintegration against closed forms, fine numerical integration, differences and Monte Carlo.
#include "alidade/inertial/preintegration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "alidade/base/random.h"
#include "support/smooth_motion.h"

namespace alidade {
namespace {

using Motion = SmoothMotion;
const Eigen::Vector3d kGravity = Motion::Gravity();

std::vector<ImuSample> Readings(double seconds, double rate, const ImuBias& bias) {
  return Motion::Readings(-1 / rate, seconds + 1 / rate, rate, bias);
}

const ImuBias kBias{{0.02, -0.01, 0.03}, {0.1, -0.15, 0.05}};

TEST(Preintegration, ReachesTheClosedFormOfASmoothMotion) {
  const auto samples = Readings(2, 1000, kBias);
  const Preintegration motion = Preintegrate(samples, 0.1003, 1.4567, kBias, {});
  EXPECT_NEAR(motion.seconds, 1.3564, 1e-12);
  const InertialState reached = Predict(Motion::At(0.1003, kBias), motion, kGravity);
  const InertialState truth = Motion::At(1.4567, kBias);
  EXPECT_LT(RotationAngle(reached.T_world_imu, truth.T_world_imu), 2e-6);
  EXPECT_LT((reached.velocity - truth.velocity).norm(), 1e-5);
  EXPECT_LT((reached.T_world_imu.t - truth.T_world_imu.t).norm(), 1e-5);
  const MotionResidual zero = ResidualOf(Motion::At(0.1003, kBias), truth, motion, kGravity);
  EXPECT_LT(zero.error.norm(), 2e-5);
}

TEST(Preintegration, ErrorFallsWithTheSquareOfTheInterval) {
  const auto error = [](double rate) {
    const auto samples = Readings(1, rate, {});
    const Preintegration motion = Preintegrate(samples, 0, 1, {}, {});
    const InertialState reached = Predict(Motion::At(0, {}), motion, kGravity);
    return (reached.T_world_imu.t - Motion::Position(1)).norm();
  };
  EXPECT_LT(error(400), 0.3 * error(200));
}

TEST(Preintegration, TwoHalvesMakeTheWhole) {
  const auto samples = Readings(1, 200, kBias);
  const InertialState start = Motion::At(0, kBias);
  const InertialState middle =
      Predict(start, Preintegrate(samples, 0, 0.5031, kBias, {}), kGravity);
  const InertialState end = Predict(middle, Preintegrate(samples, 0.5031, 1, kBias, {}), kGravity);
  const InertialState whole = Predict(start, Preintegrate(samples, 0, 1, kBias, {}), kGravity);
  EXPECT_LT((end.T_world_imu.t - whole.T_world_imu.t).norm(), 1e-5);
  EXPECT_LT(RotationAngle(end.T_world_imu, whole.T_world_imu), 1e-5);
}

TEST(Preintegration, OneThenTheNextIsBoth) {
  const auto samples = Readings(1, 200, kBias);
  const ImuNoise noise{0.01, 0.1, 1e-4, 1e-3};
  const Preintegration whole = Preintegrate(samples, 0, 1, kBias, noise);
  // 0.5 is the time of a sample, so that both are made of the same steps.
  const Preintegration first = Preintegrate(samples, 0, 0.5, kBias, noise);
  const auto expect_whole = [&](const Preintegration& second, double tolerance) {
    const Preintegration both = first.Then(second);
    EXPECT_NEAR(both.seconds, 1, 1e-12);
    EXPECT_LT((both.dR - whole.dR).norm(), tolerance);
    EXPECT_LT((both.dv - whole.dv).norm(), tolerance);
    EXPECT_LT((both.dp - whole.dp).norm(), tolerance);
    EXPECT_LT((both.covariance - whole.covariance).norm(), tolerance * whole.covariance.norm());
    EXPECT_LT((both.by_bias - whole.by_bias).norm(), tolerance * whole.by_bias.norm());
  };
  expect_whole(Preintegrate(samples, 0.5, 1, kBias, noise), 1e-9);
  ImuBias other = kBias;
  other.gyro.x() += 1e-4;
  other.accel.y() += 1e-3;
  expect_whole(Preintegrate(samples, 0.5, 1, other, noise), 1e-4);
}

TEST(Preintegration, BiasDerivativesAgreeWithIntegratingAnew) {
  const auto samples = Readings(1, 200, kBias);
  const Preintegration motion = Preintegrate(samples, 0, 1, kBias, {});
  for (int axis = 0; axis < 6; ++axis) {
    ImuBias other = kBias;
    (axis < 3 ? other.gyro : other.accel)[axis % 3] += 1e-4;
    const Preintegration anew = Preintegrate(samples, 0, 1, other, {});
    const Preintegration changed = motion.WithBias(other);
    EXPECT_LT(LogSo3(anew.dR.transpose() * changed.dR).norm(), 1e-8);
    EXPECT_LT((anew.dv - changed.dv).norm(), 2e-8);
    EXPECT_LT((anew.dp - changed.dp).norm(), 2e-8);
  }
}

TEST(Preintegration, CovarianceAgreesWithMonteCarlo) {
  const ImuNoise noise{0.01, 0.1, 1e-4, 1e-3};
  const double rate = 200, seconds = 0.5;
  const auto clean = Readings(seconds, rate, {});
  const Preintegration truth = Preintegrate(clean, 0, seconds, {}, noise);
  Matrix9d sum = Matrix9d::Zero();
  constexpr int kRuns = 2000;
  Random random(3, 1);
  for (int run = 0; run < kRuns; ++run) {
    auto noisy = clean;
    for (ImuSample& sample : noisy) {
      for (int k = 0; k < 3; ++k) {
        sample.angular_rate[k] += noise.gyro * std::sqrt(rate) * random.Gaussian();
        sample.specific_force[k] += noise.accel * std::sqrt(rate) * random.Gaussian();
      }
    }
    const Preintegration motion = Preintegrate(noisy, 0, seconds, {}, noise);
    Vector9d error;
    error << LogSo3(truth.dR.transpose() * motion.dR), motion.dv - truth.dv, motion.dp - truth.dp;
    sum += error * error.transpose();
  }
  const Matrix9d sampled = sum / kRuns;
  for (int k = 0; k < 9; ++k)  // the standard error of a variance of 2000 samples is 3 %
    EXPECT_NEAR(sampled(k, k) / truth.covariance(k, k), 1, 0.12) << k;
  const auto correlation = [](const Matrix9d& C, int a, int b) {
    return C(a, b) / std::sqrt(C(a, a) * C(b, b));
  };
  for (int a = 0; a < 9; ++a)
    for (int b = 0; b < a; ++b)
      EXPECT_NEAR(correlation(sampled, a, b), correlation(truth.covariance, a, b), 0.1);
}

TEST(Preintegration, CovarianceCoversASilenceOfTheSensor) {
  auto samples = Readings(8, 200, {});
  std::erase_if(samples, [](const ImuSample& s) { return s.time > 2 && s.time < 5; });
  const auto expect_covered = [&](double from, double to) {
    const Preintegration motion = Preintegrate(samples, from, to, {}, {});
    const MotionResidual residual =
        ResidualOf(Motion::At(from, {}), Motion::At(to, {}), motion, kGravity);
    for (int k = 0; k < 9; ++k)
      EXPECT_LT(std::abs(residual.error[k]), 3 * std::sqrt(motion.covariance(k, k))) << k;
  };
  expect_covered(1.7, 2.4);
  expect_covered(3, 3.1);  // no reading in between
  expect_covered(1.9, 5.2);
  const double before = Preintegrate(samples, 1, 1.9, {}, {}).covariance.norm();
  EXPECT_LT(Preintegrate(samples, 5.1, 6, {}, {}).covariance.norm(), 2 * before);
}

TEST(MotionResidual, DerivativesAgreeWithDifferences) {
  const auto samples = Readings(1, 200, kBias);
  const Preintegration motion = Preintegrate(samples, 0, 0.8, {{0.01, 0, 0}, {0, 0.1, 0}}, {});
  const InertialState i = Motion::At(0, {{0.012, 0.003, 0}, {0.01, 0.1, 0.02}});
  InertialState j = Motion::At(0.8, {});
  j.T_world_imu.R = j.T_world_imu.R * ExpSo3({0.05, -0.02, 0.03});
  const MotionResidual at = ResidualOf(i, j, motion, kGravity);
  const auto moved = [](InertialState state, int axis, double step) {
    Eigen::Vector3d d = Eigen::Vector3d::Zero();
    d[axis % 3] = step;
    if (axis < 3) state.T_world_imu.R = state.T_world_imu.R * ExpSo3(d);
    if (axis / 3 == 1) state.velocity += d;
    if (axis / 3 == 2) state.T_world_imu.t += d;
    if (axis / 3 == 3) state.bias.gyro += d;
    if (axis / 3 == 4) state.bias.accel += d;
    return state;
  };
  constexpr double kStep = 1e-6;
  const auto difference = [&](const InertialState& a, const InertialState& b,
                              const Eigen::Vector3d& g) -> Vector9d {
    return (ResidualOf(a, b, motion, g).error - at.error) / kStep;
  };
  for (int axis = 0; axis < 9; ++axis) {
    EXPECT_LT((difference(moved(i, axis, kStep), j, kGravity) - at.by_i.col(axis)).norm(), 1e-4);
    EXPECT_LT((difference(i, moved(j, axis, kStep), kGravity) - at.by_j.col(axis)).norm(), 1e-4);
  }
  for (int axis = 0; axis < 6; ++axis) {
    const Vector9d by = difference(moved(i, 9 + axis, kStep), j, kGravity);
    EXPECT_LT((by - at.by_bias.col(axis)).norm(), 1e-4) << axis;
  }
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d g = kGravity;
    g[axis] += kStep;
    EXPECT_LT((difference(i, j, g) - at.by_gravity.col(axis)).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace alidade
