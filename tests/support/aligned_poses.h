// Alignment of estimated camera poses with true ones by positions and directions.
#pragma once

#include <Eigen/Core>
#include <Eigen/SVD>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// The similarity T with true T_world_camera = T estimated, that minimizes the sum of the squared
// errors of all cameras, a radian counting as `length` of the estimated world. Scale 1 unless
// `with_scale`.
inline Sim3 AlignmentOf(const std::vector<Se3>& estimated, const std::vector<Se3>& real,
                        double length, bool with_scale) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  for (const Se3& pose : estimated) from += pose.t / static_cast<double>(estimated.size());
  for (const Se3& pose : real) to += pose.t / static_cast<double>(real.size());
  double from2 = 0, to2 = 0, along = 0;
  for (size_t i = 0; i < real.size(); ++i) {
    from2 += (estimated[i].t - from).squaredNorm();
    to2 += (real[i].t - to).squaredNorm();
  }
  const double scale = with_scale ? std::sqrt(to2 / from2) : 1;
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < real.size(); ++i) {
    H += scale * (real[i].t - to) * (estimated[i].t - from).transpose();
    H += 0.5 * scale * scale * length * length * real[i].R * estimated[i].R.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Sim3 T;
  T.R = svd.matrixU() * svd.matrixV().transpose();
  for (size_t i = 0; i < real.size(); ++i)
    along += (real[i].t - to).dot(T.R * (estimated[i].t - from));
  T.s = with_scale ? along / from2 : 1;
  T.t = to - T.s * (T.R * from);
  return T;
}

// xi of T_world_camera * Exp(xi) = the true pose, in units of the estimated world.
inline Vector6d ErrorAfter(const Sim3& T, const Se3& estimated, const Se3& real) {
  const Se3 in_estimated{T.R.transpose() * real.R, T.Inverse() * real.t};
  return (estimated.Inverse() * in_estimated).Log();
}

}  // namespace alidade
