#include "alidade/geometry/relative_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "alidade/geometry/fundamental.h"
#include "alidade/geometry/two_view_ransac.h"

namespace alidade {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

// Signed Sampson distance in sigma: b' E a divided by the norm of its gradient over the four image
// coordinates.
struct Sampson {
  double residual;
  double inverse_gradient;
};

inline Sampson SampsonOf(const Eigen::Matrix3d& E, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b, const Eigen::Vector2d& sigma) {
  const Eigen::Vector3d line_b = E * a;
  const Eigen::Vector2d line_a = E.leftCols<2>().transpose() * b;
  const double inverse_gradient =
      1 / std::sqrt((line_b.head<2>().cwiseProduct(sigma)).squaredNorm() +
                    line_a.cwiseProduct(sigma).squaredNorm());
  return {b.dot(line_b) * inverse_gradient, inverse_gradient};
}

// Two unit vectors perpendicular to t and to each other.
Eigen::Matrix<double, 3, 2> TangentPlane(const Eigen::Vector3d& t) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = t.unitOrthogonal();
  basis.col(1) = t.cross(basis.col(0));
  return basis;
}

struct NormalEquations {
  Matrix5d H = Matrix5d::Zero();
  Vector5d g = Vector5d::Zero();
  double gain = 0;     // truncated least-squares objective, maximized
  double squares = 0;  // sum of squared residuals within the bound
  int count = 0;
};

// Unknowns: rotation vector w (R <- Exp(w) R) and d (t <- t + basis * d). The derivative of the
// Sampson denominator is omitted: it is multiplied by the residual, which is small.
NormalEquations Linearise(const Se3& T, const Eigen::Matrix<double, 3, 2>& basis,
                          const RayPairs& rays, double bound) {
  NormalEquations n;
  const Eigen::Matrix3d E = EssentialFromMotion(T);
  for (size_t i = 0; i < rays.size(); ++i) {
    const Sampson sampson = SampsonOf(E, rays.a[i], rays.b[i], rays.sigma);
    const double squared = sampson.residual * sampson.residual;
    if (!(squared < bound)) continue;
    n.gain += bound - squared;
    n.squares += squared;
    ++n.count;
    const Eigen::Vector3d turned = T.R * rays.a[i];
    Vector5d j;
    j.head<3>() = turned.cross(rays.b[i].cross(T.t));           // d(b' [t] Exp(w) R a) / dw
    j.tail<2>() = basis.transpose() * turned.cross(rays.b[i]);  // d(b' [t + dt] R a) / dt
    j *= sampson.inverse_gradient;
    n.H += j * j.transpose();
    n.g += j * sampson.residual;
  }
  return n;
}

}  // namespace

MotionScore ScoreMotion(const Se3& T_b_a, const RayPairs& rays, double widening) {
  MotionScore result;
  result.gain.assign(rays.size(), 0);
  const Eigen::Matrix3d E = EssentialFromMotion(T_b_a);
  // Rays closer to parallel than this (noise of 3 sigma in each) may intersect anywhere, even
  // behind the cameras.
  const double sine_far = 3 * std::sqrt(2.0) * rays.sigma.maxCoeff();
  for (size_t i = 0; i < rays.size(); ++i) {
    const double residual = SampsonOf(E, rays.a[i], rays.b[i], rays.sigma).residual;
    const double gain = widening * kChi2Fundamental - residual * residual;
    if (!(gain > 0)) continue;
    ++result.consistent;
    // Depths z_a and z_b at which z_a R a + t is closest to z_b b; only their signs are used.
    const Eigen::Vector3d turned = T_b_a.R * rays.a[i];
    const Eigen::Vector3d& b = rays.b[i];
    const double aa = turned.squaredNorm(), bb = b.squaredNorm(), ab = turned.dot(b);
    const double at = turned.dot(T_b_a.t), bt = b.dot(T_b_a.t);
    const double squared_sine = 1 - ab * ab / (aa * bb);
    const bool in_front = ab * bt > bb * at && aa * bt > ab * at;
    const bool far = ab > 0 && squared_sine < sine_far * sine_far;
    if (!in_front && !far) continue;
    ++result.good;
    result.placed += !far;
    result.gain[i] = static_cast<float>(gain);
    result.score += gain;
  }
  return result;
}

RefinedMotion RefineMotion(const Se3& start, const RayPairs& rays, double widest) {
  RefinedMotion refined;
  refined.T_b_a = start;
  NormalEquations n;
  for (const double widening : {100.0, 25.0, 9.0, 4.0, 1.0}) {
    if (widening > widest) continue;
    const double bound = widening * kChi2Fundamental;
    Eigen::Matrix<double, 3, 2> basis = TangentPlane(refined.T_b_a.t);
    n = Linearise(refined.T_b_a, basis, rays, bound);
    for (int iteration = 0; iteration < 10 && n.count > 5; ++iteration) {
      Matrix5d damped = n.H;
      damped.diagonal() *= 1 + 1e-6;
      const Vector5d step = -damped.ldlt().solve(n.g);
      if (!step.allFinite() || step.norm() > 0.5) break;
      Se3 next;
      next.R = ExpSo3(step.head<3>()) * refined.T_b_a.R;
      next.t = (refined.T_b_a.t + basis * step.tail<2>()).normalized();
      const Eigen::Matrix<double, 3, 2> next_basis = TangentPlane(next.t);
      const NormalEquations next_n = Linearise(next, next_basis, rays, bound);
      if (!(next_n.gain > n.gain)) break;
      const bool settled = next_n.gain - n.gain < (widening > 1 ? 1e-2 : 1e-5) * n.gain;
      refined.T_b_a = next;
      basis = next_basis;
      n = next_n;
      if (settled) break;
    }
  }
  refined.T_b_a = refined.T_b_a.Normalised();
  const double found = n.squares / std::max(1, n.count - 5);
  refined.noise = std::sqrt(found);
  const double variance = std::max(0.25, found);
  const Eigen::SelfAdjointEigenSolver<Matrix5d> spectrum(n.H);
  const Matrix5d covariance = variance * spectrum.eigenvectors() *
                              spectrum.eigenvalues()
                                  .cwiseMax(1e-12 * spectrum.eigenvalues()[4])
                                  .cwiseInverse()
                                  .asDiagonal() *
                              spectrum.eigenvectors().transpose();
  const auto worst = [](const auto& block) {
    return std::sqrt(block.norm());  // Frobenius norm: slightly above the largest eigenvalue
  };
  refined.rotation_sigma = worst(covariance.topLeftCorner<3, 3>());
  refined.direction_sigma = worst(covariance.bottomRightCorner<2, 2>());
  return refined;
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& m) {
  if (!m.allFinite()) return Eigen::Matrix3d::Identity();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

std::vector<bool> ExplainedByRotation(const Eigen::Matrix3d& start, const RayPairs& rays) {
  Eigen::Matrix3d R = start;
  std::vector<bool> explained(rays.size(), false);
  for (const double widening : {16.0, 4.0, 1.0, 1.0, 1.0}) {
    // The difference of two images has twice the variance of one.
    const double bound = widening * 2 * kChi2Homography;
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
    for (size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Vector3d turned = R * rays.a[i];
      const Eigen::Vector2d error =
          (turned.head<2>() / turned.z() - rays.b[i].head<2>()).cwiseQuotient(rays.sigma);
      explained[i] = turned.z() > 0 && error.squaredNorm() < bound;
      if (!explained[i]) continue;
      correlation += rays.b[i] * (rays.a[i].transpose() / (rays.a[i].norm() * rays.b[i].norm()));
    }
    R = NearestRotation(correlation);  // closed form (Umeyama 1991)
  }
  return explained;
}

}  // namespace alidade
