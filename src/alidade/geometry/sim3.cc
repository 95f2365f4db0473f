#include "alidade/geometry/sim3.h"

#include <Eigen/LU>
#include <cmath>

namespace alidade {
namespace {

// V in translation(Exp(xi)) = V ν: the integral of e^(στ) Exp(τ ω) over τ from 0 to 1, equal to c I
// + a [ω]x + b [ω]x².
Eigen::Matrix3d TranslationFactor(const Eigen::Vector3d& w, double sigma) {
  const double angle2 = w.squaredNorm(), length2 = sigma * sigma + angle2;
  double a = 0, b = 0, c = 0;
  if (length2 < 1) {
    // Power series of ([ω]x + σ I)ⁿ / (n + 1)!, since the closed form loses digits here. For an
    // argument below 1 the twentieth term is below rounding.
    double an = 0, bn = 0, cn = 1, real = 1, factorial = 1;
    for (int n = 0; n < 20; ++n) {
      factorial *= n + 1;
      a += an / factorial;
      b += bn / factorial;
      c += cn / factorial;
      bn = sigma * bn + an;  // (σⁿ - Re zⁿ) / θ², z = σ + iθ
      const double next = sigma * an + real;
      real = sigma * real - angle2 * an;
      an = next;  // Im zⁿ / θ
      cn *= sigma;
    }
  } else {
    const double angle = std::sqrt(angle2), s = std::exp(sigma), half = angle / 2;
    const double sinc = angle < 1e-4 ? 1 - angle2 / 6 : std::sin(angle) / angle;
    const double half_sinc = angle < 1e-4 ? 1 - angle2 / 24 : std::sin(half) / half;
    c = std::abs(sigma) < 1e-12 ? 1 : std::expm1(sigma) / sigma;
    a = (s * (sigma * sinc - std::cos(angle)) + 1) / length2;
    b = (c + s * (sigma * half_sinc * half_sinc / 2 - sinc)) / length2;
  }
  const Eigen::Matrix3d W = Skew(w);
  return c * Eigen::Matrix3d::Identity() + a * W + b * (W * W);
}

// Blocks of the left Jacobian that are neither zero nor one: (V, Q, q; 0, J, 0; 0, 0, 1).
struct JacobianBlocks {
  Eigen::Matrix3d V, Q, J;
  Eigen::Vector3d q;
};

// Sum of adⁿ / (n + 1)! with ad = ([ω]x + σ I, [ν]x, -ν; 0, [ω]x, 0; 0, 0, 0). Converges for every
// argument: ad is large only through ν, and the factors of ν decay like the series of ω and σ.
JacobianBlocks SumJacobian(const Vector7d& xi) {
  const Eigen::Matrix3d W = Skew(xi.segment<3>(3)), N = Skew(xi.head<3>());
  const Eigen::Matrix3d M = W + xi[6] * Eigen::Matrix3d::Identity();
  // One term: the blocks of adⁿ / (n + 1)!.
  Eigen::Matrix3d v = Eigen::Matrix3d::Identity(), u = Eigen::Matrix3d::Zero(), j = v;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  JacobianBlocks sum{v, u, j, p};
  for (int n = 1; n < 100; ++n) {
    const double inverse = 1.0 / (n + 1);
    p = -inverse * (v * xi.head<3>());
    u = (inverse * (v * N + u * W)).eval();
    v = (inverse * (v * M)).eval();
    j = (inverse * (j * W)).eval();
    sum.V += v;
    sum.Q += u;
    sum.J += j;
    sum.q += p;
    const auto small = [](const auto& term, const auto& of) {
      return term.squaredNorm() <= 1e-34 * of.squaredNorm();
    };
    // Only after n = 2: for a zero rotation the first terms of Q may vanish.
    if (n > 2 && small(v, sum.V) && small(u, sum.Q) && small(j, sum.J) && small(p, sum.q)) break;
  }
  return sum;
}

}  // namespace

Sim3 ExpSim3(const Vector7d& xi) {
  const Eigen::Vector3d w = xi.segment<3>(3);
  return {std::exp(xi[6]), ExpSo3(w), TranslationFactor(w, xi[6]) * xi.head<3>()};
}

Vector7d LogSim3(const Sim3& T) {
  const Eigen::Vector3d w = LogSo3(T.R);
  const double sigma = std::log(T.s);
  Vector7d xi;
  xi << TranslationFactor(w, sigma).partialPivLu().solve(T.t), w, sigma;
  return xi;
}

Matrix7d AdjointSim3(const Sim3& T) {
  Matrix7d Ad = Matrix7d::Zero();
  Ad.block<3, 3>(0, 0) = T.s * T.R;
  Ad.block<3, 3>(0, 3) = Skew(T.t) * T.R;
  Ad.block<3, 1>(0, 6) = -T.t;
  Ad.block<3, 3>(3, 3) = T.R;
  Ad(6, 6) = 1;
  return Ad;
}

Matrix7d LeftJacobianSim3(const Vector7d& xi) {
  const JacobianBlocks blocks = SumJacobian(xi);
  Matrix7d J = Matrix7d::Zero();
  J.block<3, 3>(0, 0) = blocks.V;
  J.block<3, 3>(0, 3) = blocks.Q;
  J.block<3, 1>(0, 6) = blocks.q;
  J.block<3, 3>(3, 3) = blocks.J;
  J(6, 6) = 1;
  return J;
}

Matrix7d LeftJacobianInverseSim3(const Vector7d& xi) {
  const JacobianBlocks blocks = SumJacobian(xi);
  const Eigen::Matrix3d V = blocks.V.inverse(), J = blocks.J.inverse();
  Matrix7d inverse = Matrix7d::Zero();
  inverse.block<3, 3>(0, 0) = V;
  inverse.block<3, 3>(0, 3) = -V * blocks.Q * J;
  inverse.block<3, 1>(0, 6) = -V * blocks.q;
  inverse.block<3, 3>(3, 3) = J;
  inverse(6, 6) = 1;
  return inverse;
}

}  // namespace alidade
