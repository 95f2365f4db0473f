#include "alidade/geometry/se3.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "alidade/base/random.h"
#include "problems/two_view_problem.h"

namespace alidade::se3_test {
namespace {

// Matrix exponential by power series with scaling and squaring.
template <int N>
Eigen::Matrix<double, N, N> PowerSeries(Eigen::Matrix<double, N, N> m) {
  m /= 1024;
  Eigen::Matrix<double, N, N> sum = Eigen::Matrix<double, N, N>::Identity(), term = sum;
  for (int k = 1; k < 15; ++k) {
    term = term * m / k;
    sum += term;
  }
  for (int i = 0; i < 10; ++i) sum = (sum * sum).eval();
  return sum;
}

Eigen::Matrix4d Matrix(const Se3& T) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = T.R;
  m.topRightCorner<3, 1>() = T.t;
  return m;
}

Vector6d RandomTangent(Random& random, double angle) {
  Vector6d xi;
  for (int i = 0; i < 3; ++i) xi[i] = 3 * random.Gaussian();
  xi.tail<3>() = angle * RandomDirection(random);
  return xi;
}

constexpr double kAngles[] = {0, 1e-15, 1e-9, 1e-6, 0.99e-4, 1.01e-4, 1e-3, 0.1, 1, 2, 3, 3.14};

TEST(Se3, ExponentialIsThePowerSeries) {
  Random random(1);
  for (const double angle : kAngles) {
    const Vector6d xi = RandomTangent(random, angle);
    Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
    generator.topLeftCorner<3, 3>() = Skew(xi.tail<3>());
    generator.topRightCorner<3, 1>() = xi.head<3>();
    EXPECT_LT((Matrix(Se3::Exp(xi)) - PowerSeries<4>(generator)).norm(), 1e-11) << angle;
  }
}

TEST(Se3, LogarithmUndoesTheExponential) {
  Random random(2);
  for (const double angle : kAngles) {
    for (int trial = 0; trial < 20; ++trial) {
      const Vector6d xi = RandomTangent(random, angle);
      EXPECT_LT((Se3::Exp(xi).Log() - xi).norm(), 1e-9 * (1 + xi.norm())) << angle;
    }
  }
}

TEST(Se3, HandlesHalfTurns) {
  Random random(3);
  for (const double angle : {std::numbers::pi - 1e-3, std::numbers::pi - 1e-8, std::numbers::pi}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::Matrix3d R = ExpSo3(angle * RandomDirection(random));
      const Eigen::Vector3d w = LogSo3(R);
      EXPECT_NEAR(w.norm(), angle, 1e-7);
      EXPECT_LT((ExpSo3(w) - R).norm(), 1e-7);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Matrix3d R = (2 * Eigen::Vector3d::Unit(axis) * Eigen::RowVector3d::Unit(axis)) -
                              Eigen::Matrix3d::Identity();
    EXPECT_NEAR(LogSo3(R).norm(), std::numbers::pi, 1e-12);
  }
}

TEST(Se3, ComposesAndInvertsLikeMatrices) {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Se3 a = Se3::Exp(RandomTangent(random, 1)), b = Se3::Exp(RandomTangent(random, 2));
    EXPECT_LT((Matrix(a * b) - Matrix(a) * Matrix(b)).norm(), 1e-12);
    EXPECT_LT((Matrix(a.Inverse()) - Matrix(a).inverse()).norm(), 1e-12);
    const Eigen::Vector3d p(1, 2, 3);
    EXPECT_LT(((Matrix(a) * p.homogeneous()).head<3>() - a * p).norm(), 1e-12);
    EXPECT_NEAR(RotationAngle(a, a * b), 2, 1e-12);
  }
}

TEST(Se3, QuaternionGoesThereAndBack) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Se3 T = Se3::Exp(RandomTangent(random, random.Uniform(0, 3.14)));
    const Eigen::Quaterniond q = T.Quaternion();
    EXPECT_GE(q.w(), 0);
    EXPECT_NEAR(q.norm(), 1, 1e-15);
    const Eigen::Quaterniond doubled(2 * q.w(), 2 * q.x(), 2 * q.y(), 2 * q.z());
    EXPECT_LT((Se3::FromQuaternion(doubled, T.t).R - T.R).norm(), 1e-13);
  }
}

TEST(Se3, NormalisedIsARotationAgain) {
  Random random(6);
  Se3 T = Se3::Exp(RandomTangent(random, 1));
  T.R += 1e-4 * Eigen::Matrix3d::Random();
  const Eigen::Matrix3d R = T.Normalised().R;
  EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((R - T.R).norm(), 1e-3);
}

TEST(Sim3, ComposesAndInverts) {
  Random random(7);
  const Se3 x = Se3::Exp(RandomTangent(random, 1)), y = Se3::Exp(RandomTangent(random, 2));
  const Sim3 a{2.5, x.R, x.t}, b{0.3, y.R, y.t};
  const Eigen::Vector3d p(1, -2, 3);
  EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
  EXPECT_LT((a.Inverse() * (a * p) - p).norm(), 1e-12);
}

}  // namespace
}  // namespace alidade::se3_test
