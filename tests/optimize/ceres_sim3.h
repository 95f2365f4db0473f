// Sim(3) implemented independently for Ceres' automatic derivatives; the logarithm solves for the
// translation with the integral by quadrature.
#pragma once

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "alidade/geometry/sim3.h"

namespace alidade {

// Similarity parameters for Ceres: rotation vector, translation, log scale.
inline Vector7d ToCeresSim3(const Sim3& T) {
  Vector7d x;
  x << LogSo3(T.R), T.t, std::log(T.s);
  return x;
}
inline Sim3 FromCeresSim3(const Vector7d& x) {
  return {std::exp(x[6]), ExpSo3(x.head<3>()), x.segment<3>(3)};
}

template <typename T>
struct CeresSim3 {
  Eigen::Quaternion<T> q;
  Eigen::Matrix<T, 3, 1> t;
  T log_s;

  static CeresSim3 Of(const T* x) {
    T q[4];
    ceres::AngleAxisToQuaternion(x, q);
    return {Eigen::Quaternion<T>(q[0], q[1], q[2], q[3]), {x[3], x[4], x[5]}, x[6]};
  }
  static CeresSim3 Of(const Sim3& T_) {
    return {Eigen::Quaterniond(T_.R).cast<T>(), T_.t.cast<T>(), T(std::log(T_.s))};
  }
  CeresSim3 operator*(const CeresSim3& o) const {
    return {q * o.q, exp(log_s) * (q * o.t) + t, log_s + o.log_s};
  }
  CeresSim3 Inverse() const { return {q.conjugate(), -(q.conjugate() * t) * exp(-log_s), -log_s}; }
  Eigen::Matrix<T, 3, 1> operator*(const Eigen::Matrix<T, 3, 1>& p) const {
    return exp(log_s) * (q * p) + t;
  }

  // Returns (translation; rotation; log scale). V is the mean of e^(στ) Exp(τ ω); Gauss–Legendre
  // quadrature with ten nodes is exact to 1e-12 for rotations up to π.
  Eigen::Matrix<T, 7, 1> Log() const {
    const T q_[4] = {q.w(), q.x(), q.y(), q.z()};
    T w[3];
    ceres::QuaternionToAngleAxis(q_, w);
    static constexpr double kNode[] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                       0.8650633666889845, 0.9739065285171717};
    static constexpr double kWeight[] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                         0.1494513491505806, 0.0666713443086881};
    Eigen::Matrix<T, 3, 3> V = Eigen::Matrix<T, 3, 3>::Zero();
    for (int i = 0; i < 10; ++i) {
      const double tau = 0.5 + (i < 5 ? 0.5 : -0.5) * kNode[i % 5];
      const T turn[3] = {tau * w[0], tau * w[1], tau * w[2]};
      T R[9];
      ceres::AngleAxisToRotationMatrix(turn, R);  // column-major
      V += 0.5 * kWeight[i % 5] * exp(tau * log_s) * Eigen::Map<Eigen::Matrix<T, 3, 3>>(R);
    }
    Eigen::Matrix<T, 7, 1> xi;
    xi.template head<3>() = V.inverse() * t;
    xi.template segment<3>(3) = Eigen::Map<Eigen::Matrix<T, 3, 1>>(w);
    xi[6] = log_s;
    return xi;
  }
};

}  // namespace alidade
