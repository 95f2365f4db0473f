// Rigid motions and similarities. T_a_b maps points of frame b to frame a: p_a = T_a_b * p_b.
// Tangent vectors are (translation; rotation); increments act from the left: T <- Exp(xi) * T
// (Solà, Deray & Atchuthan 2018, example 4).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

static_assert(
    EIGEN_MAX_STATIC_ALIGN_BYTES == 16,
    "the library was compiled with -DEIGEN_MAX_STATIC_ALIGN_BYTES=16, which CMake's "
    "Alidade::Alidade and pkg-config's alidade hand on: values with Eigen inside would be "
    "laid out otherwise");

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

inline Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

Eigen::Matrix3d ExpSo3(const Eigen::Vector3d& rotation_vector);  // rotation vector in radians
Eigen::Vector3d LogSo3(const Eigen::Matrix3d& rotation);         // radians, norm in [0, pi]

struct Se3 {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  static Se3 FromQuaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& t) {
    return {q.normalized().toRotationMatrix(), t};
  }
  static Se3 Exp(const Vector6d& xi);
  Vector6d Log() const;

  Se3 Inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
  Eigen::Quaterniond Quaternion() const;  // unit, w >= 0
  Se3 Normalised() const;                 // rotation made orthonormal again after many products

  friend Se3 operator*(const Se3& a, const Se3& b) { return {a.R * b.R, a.R * b.t + a.t}; }
  friend Eigen::Vector3d operator*(const Se3& a, const Eigen::Vector3d& p) { return a.R * p + a.t; }
};

// Covariance of Ad xi, where xi has `covariance` and X Exp(xi) X⁻¹ = Exp(Ad xi) (Solà et al. 2018,
// example 6): an error of T_world_b is carried to T_world_a = T_world_b T_b_a by X = T_a_b.
Matrix6d Carried(const Se3& X, const Matrix6d& covariance);

// Angle of the relative rotation, radians.
double RotationAngle(const Se3& a, const Se3& b);

// Similarity: p_a = s * R * p_b + t.
struct Sim3 {
  double s = 1;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  Sim3 Inverse() const { return {1 / s, R.transpose(), -(R.transpose() * t) / s}; }
  friend Sim3 operator*(const Sim3& a, const Sim3& b) {
    return {a.s * b.s, a.R * b.R, a.s * (a.R * b.t) + a.t};
  }
  friend Eigen::Vector3d operator*(const Sim3& a, const Eigen::Vector3d& p) {
    return a.s * (a.R * p) + a.t;
  }
};

}  // namespace alidade
