#include "alidade/geometry/se3.h"

#include <cmath>

namespace alidade {

namespace {
// (1 - cos x) / x², without the cancellation that loses half of the digits at small angles.
double HalfVersine(double x) {
  const double half = x / 2, quotient = half < 1e-4 ? 1 - half * half / 6 : std::sin(half) / half;
  return quotient * quotient / 2;
}
}  // namespace

Eigen::Matrix3d ExpSo3(const Eigen::Vector3d& w) {
  const double angle2 = w.squaredNorm(), angle = std::sqrt(angle2);
  // Taylor series below 1e-4 rad, where the quotient loses digits.
  const double a = angle < 1e-4 ? 1 - angle2 / 6 : std::sin(angle) / angle;
  const double b = HalfVersine(angle);
  const Eigen::Matrix3d W = Skew(w);
  return Eigen::Matrix3d::Identity() + a * W + b * (W * W);
}

Eigen::Vector3d LogSo3(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  const double n = q.vec().norm();
  if (n < 1e-12) return 2 * q.vec() * (q.w() < 0 ? -1.0 : 1.0);
  const double half = std::atan2(n, std::abs(q.w()));
  return (2 * half / n * (q.w() < 0 ? -1.0 : 1.0)) * q.vec();
}

namespace {
// V in translation(Exp(rho; w)) = V * rho (Solà et al. 2018, eq. 174).
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& w) {
  const double angle2 = w.squaredNorm(), angle = std::sqrt(angle2);
  const double b = HalfVersine(angle);
  const double c =
      angle < 1e-4 ? 1.0 / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle2 * angle);
  const Eigen::Matrix3d W = Skew(w);
  return Eigen::Matrix3d::Identity() + b * W + c * (W * W);
}
}  // namespace

Se3 Se3::Exp(const Vector6d& xi) {
  const Eigen::Vector3d w = xi.tail<3>();
  return {ExpSo3(w), LeftJacobian(w) * xi.head<3>()};
}

Vector6d Se3::Log() const {
  Vector6d xi;
  xi.tail<3>() = LogSo3(R);
  xi.head<3>() = LeftJacobian(xi.tail<3>()).partialPivLu().solve(t);
  return xi;
}

Eigen::Quaterniond Se3::Quaternion() const {
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return q;
}

Se3 Se3::Normalised() const { return {Quaternion().toRotationMatrix(), t}; }

Matrix6d Carried(const Se3& X, const Matrix6d& covariance) {
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = X.R;
  ad.topRightCorner<3, 3>() = Skew(X.t) * X.R;
  return ad * covariance * ad.transpose();
}

double RotationAngle(const Se3& a, const Se3& b) { return LogSo3(a.R.transpose() * b.R).norm(); }

}  // namespace alidade
