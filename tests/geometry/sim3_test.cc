#include "alidade/geometry/sim3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "alidade/base/random.h"
#include "problems/two_view_problem.h"

namespace alidade::sim3_test {
namespace {

Eigen::Matrix4d Matrix(const Sim3& T) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = T.s * T.R;
  m.topRightCorner<3, 1>() = T.t;
  return m;
}

Eigen::Matrix4d Generator(const Vector7d& xi) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m.topLeftCorner<3, 3>() = Skew(xi.segment<3>(3)) + xi[6] * Eigen::Matrix3d::Identity();
  m.topRightCorner<3, 1>() = xi.head<3>();
  return m;
}

// Matrix of the commutator with xi.
Matrix7d SmallAdjoint(const Vector7d& xi) {
  Matrix7d ad = Matrix7d::Zero();
  for (int j = 0; j < 7; ++j) {
    const Eigen::Matrix4d x = Generator(xi), y = Generator(Vector7d::Unit(j));
    const Eigen::Matrix4d z = x * y - y * x;
    ad.col(j) << z(0, 3), z(1, 3), z(2, 3), z(2, 1), z(0, 2), z(1, 0), z(0, 0);
  }
  return ad;
}

Vector7d Tangent(Random& random, double angle, double sigma) {
  Vector7d xi;
  for (int i = 0; i < 3; ++i) xi[i] = 3 * random.Gaussian();
  xi.segment<3>(3) = angle * RandomDirection(random);
  xi[6] = sigma;
  return xi;
}

constexpr double kAngles[] = {0, 1e-15, 1e-9, 0.99e-4, 1.01e-4, 1e-3, 0.1, 0.99, 1.01, 2, 3.14};
constexpr double kLogScales[] = {0,   1e-13, -1e-13, 1e-6, -1e-6, 1e-3, 0.1,
                                 0.7, -0.7,  1.5,    -1.5, 4,     -4};

template <typename Body>
void ForTangents(Body body) {
  Random random(1);
  for (const double angle : kAngles) {
    for (const double sigma : kLogScales) {
      SCOPED_TRACE(testing::Message() << "angle " << angle << " log scale " << sigma);
      body(Tangent(random, angle, sigma));
    }
  }
}

TEST(Sim3, ExponentialIsThatOfTheMatrix) {
  ForTangents([](const Vector7d& xi) {
    const Eigen::Matrix4d expected = Generator(xi).exp();
    EXPECT_LT((Matrix(ExpSim3(xi)) - expected).norm(), 1e-13 * (1 + expected.norm()));
  });
}

TEST(Sim3, LogarithmUndoesTheExponential) {
  ForTangents([](const Vector7d& xi) {
    EXPECT_LT((LogSim3(ExpSim3(xi)) - xi).norm(), 1e-9 * (1 + xi.norm()));
  });
}

TEST(Sim3, WithoutScaleItIsTheRigidMotion) {
  Random random(3);
  for (const double angle : kAngles) {
    const Vector7d xi = Tangent(random, angle, 0);
    const Sim3 T = ExpSim3(xi);
    const Se3 rigid = Se3::Exp(xi.head<6>());
    EXPECT_EQ(T.s, 1);
    EXPECT_LT((T.t - rigid.t).norm(), 1e-13 * (1 + rigid.t.norm())) << angle;
    EXPECT_EQ(T.R, rigid.R);
  }
}

TEST(Sim3, AdjointCarriesAnIncrementAcross) {
  ForTangents([](const Vector7d& xi) {
    const Sim3 T = ExpSim3(xi);
    Random random(5);
    const Vector7d d = 0.1 * Tangent(random, 1, 0.5);
    const Eigen::Matrix4d left = Matrix(T * ExpSim3(d)),
                          right = Matrix(ExpSim3(AdjointSim3(T) * d) * T);
    EXPECT_LT((left - right).norm(), 1e-11 * (1 + left.norm()));
  });
}

// The integral of Exp(τ ad) over τ, as a block of the exponential of a matrix of twice the size.
TEST(Sim3, LeftJacobianIsTheIntegralOfTheAdjoint) {
  ForTangents([](const Vector7d& xi) {
    Eigen::Matrix<double, 14, 14> large = Eigen::Matrix<double, 14, 14>::Zero();
    large.topLeftCorner<7, 7>() = SmallAdjoint(xi);
    large.topRightCorner<7, 7>().setIdentity();
    const Matrix7d expected = large.exp().topRightCorner<7, 7>();
    EXPECT_LT((LeftJacobianSim3(xi) - expected).norm(), 1e-11 * expected.norm());
    const Matrix7d product = LeftJacobianInverseSim3(xi) * expected;
    EXPECT_LT((product - Matrix7d::Identity()).norm(), 1e-9 * expected.norm());
  });
}

TEST(Sim3, InverseJacobianIsTheDerivativeOfTheLogarithm) {
  ForTangents([](const Vector7d& xi) {
    if (xi.segment<3>(3).norm() > 3.1) return;  // finite differences would cross the half turn
    const Matrix7d J = LeftJacobianInverseSim3(xi);
    Matrix7d numeric;
    const double h = 1e-5;
    for (int j = 0; j < 7; ++j) {
      const Vector7d d = h * Vector7d::Unit(j);
      numeric.col(j) =
          (LogSim3(ExpSim3(d) * ExpSim3(xi)) - LogSim3(ExpSim3(-d) * ExpSim3(xi))) / (2 * h);
    }
    EXPECT_LT((J - numeric).norm(), 1e-6 * J.norm());
  });
}

}  // namespace
}  // namespace alidade::sim3_test
