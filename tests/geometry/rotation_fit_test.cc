// Rotation between two views from directions with noise and outliers.
#include "alidade/geometry/rotation_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/geometry/se3.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kNoise = 1e-3;  // radians: half a pixel at 500 pixels of focal length

struct Directions {
  std::vector<Vector3d> a, b;

  // `translation` over a depth of 1 to 3.
  Directions(const Matrix3d& R_a_b, double outliers, const Vector3d& translation, uint64_t seed) {
    Random random(seed, 3);
    for (int i = 0; i < 300; ++i) {
      const Vector3d p =
          random.Uniform(1, 3) * Vector3d(random.Uniform(-0.5, 0.5), random.Uniform(-0.4, 0.4), 1);
      Vector3d seen = R_a_b * p + translation;
      if (random.Uniform() < outliers)
        seen = {random.Uniform(-0.5, 0.5), random.Uniform(-0.4, 0.4), 1};
      for (int k = 0; k < 2; ++k) seen[k] += kNoise * seen.z() * random.Gaussian();
      a.push_back(seen.normalized());
      b.push_back(p.normalized());
    }
  }
};

TEST(FitRotation, FindsTheTurnAmongOutliersAsWellAsItSays) {
  double sum = 0;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    const Matrix3d R = ExpSo3({0.08, -0.2, 0.05});
    const Directions seen(R, 0.3, Vector3d::Zero(), 20 + run);
    const RotationFit fit = FitRotation(seen.a, seen.b, R * ExpSo3({0.03, 0.02, -0.02}), 1e-5);
    EXPECT_GT(fit.inliers, 180);
    EXPECT_NEAR(fit.residual, kNoise, 0.6 * kNoise);  // outliers make the median larger
    const Vector3d error = LogSo3(fit.R_a_b.transpose() * R);
    EXPECT_LT(error.norm(), 2e-3);
    sum += error.dot(fit.information * error) * fit.inliers / (3 * kNoise * kNoise);
  }
  EXPECT_NEAR(sum / kRuns, 1, 0.5);
}

TEST(FitRotation, TellsThatTheCameraMoved) {
  const Matrix3d R = ExpSo3({0, 0.1, 0});
  const Directions seen(R, 0, {0.05, 0, 0}, 4);
  const RotationFit fit = FitRotation(seen.a, seen.b, R, 1e-5);
  // The rotation is off by 0.05 over the mean distance, and the residual is a fifth of that.
  const double error = LogSo3(fit.R_a_b.transpose() * R).norm();
  EXPECT_NEAR(error, 0.025, 0.005);
  EXPECT_NEAR(fit.residual, error / 5, error / 20);
}

TEST(FitRotation, StaysARotationInAChain) {
  Matrix3d R_view = ExpSo3({0.3, -0.2, 0.1}), R = R_view;
  for (int k = 0; k < 300; ++k) {
    const Directions seen(ExpSo3({0, 0.001 * k, 0}), 0, Vector3d::Zero(), 5 + k);
    R = R_view * FitRotation(seen.a, seen.b, R_view.transpose() * R, 1e-5).R_a_b;
    if (k % 20 == 0) R_view = R;
  }
  EXPECT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-12);
}

TEST(FitRotation, NeedsThreeMatches) {
  const Matrix3d R = ExpSo3({0, 0.1, 0});
  const std::vector<Vector3d> two = {{0, 0, 1}, {0.1, 0, 1}};
  const RotationFit fit = FitRotation(two, two, R, 1e-3);
  EXPECT_EQ(fit.inliers, 0);
  EXPECT_LT((fit.R_a_b - R).norm(), 1e-15);
}

}  // namespace
}  // namespace alidade
