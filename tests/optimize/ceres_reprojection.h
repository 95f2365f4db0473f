// The residuals of optimize/, implemented independently for Ceres' automatic derivatives.
#pragma once

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <cmath>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

// Pose parameters for Ceres: rotation vector, then translation.
inline Eigen::Matrix<double, 6, 1> ToCeresPose(const Se3& T) {
  Eigen::Matrix<double, 6, 1> pose;
  pose << LogSo3(T.R), T.t;
  return pose;
}
inline Se3 FromCeresPose(const Eigen::Matrix<double, 6, 1>& pose) {
  return {ExpSo3(pose.head<3>()), pose.tail<3>()};
}

template <bool kStereo>
struct CeresReprojection {
  Camera camera;
  Eigen::Vector3d pixel;
  double inv_sigma2, inv_sigma2_right;

  template <typename T>
  bool operator()(const T* pose, const T* point, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(pose, point, p);
    for (int i = 0; i < 3; ++i) p[i] += pose[3 + i];
    const double w = std::sqrt(inv_sigma2);
    const T u = camera.fx * p[0] / p[2] + camera.cx;
    residual[0] = w * (u - pixel.x());
    residual[1] = w * (camera.fy * p[1] / p[2] + camera.cy - pixel.y());
    if constexpr (kStereo) {
      residual[2] = std::sqrt(inv_sigma2_right) * (camera.bf() / p[2] - (pixel.x() - pixel.z()));
    }
    return true;
  }
};

// Cost function of (pose[6], point[3]), owned by the caller.
template <typename Observation>
ceres::CostFunction* MakeCeresReprojection(const Camera& camera, const Observation& o) {
  if (std::isfinite(o.pixel.z())) {
    return new ceres::AutoDiffCostFunction<CeresReprojection<true>, 3, 6, 3>(
        new CeresReprojection<true>{camera, o.pixel, o.inv_sigma2, o.inv_sigma2_right});
  }
  return new ceres::AutoDiffCostFunction<CeresReprojection<false>, 2, 6, 3>(
      new CeresReprojection<false>{camera, o.pixel, o.inv_sigma2, o.inv_sigma2_right});
}

}  // namespace alidade
