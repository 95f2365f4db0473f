#include "alidade/inertial/imu.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"

namespace alidade {

void ImuModel::Check() const {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  const Eigen::Matrix3d& R = T_camera_imu.R;
  const bool rotation =
      (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-3 && R.determinant() > 0;
  if (!rotation) ThrowUsage("imu: T_camera_imu is not a rotation and a translation");
  if (!T_camera_imu.t.allFinite()) ThrowUsage("imu: the translation of T_camera_imu is not finite");
  if (!positive(noise.gyro) || !positive(noise.accel) || !positive(noise.gyro_walk) ||
      !positive(noise.accel_walk))
    ThrowUsage("imu: noise densities must be above 0");
  if (!std::isfinite(time_offset)) ThrowUsage("imu: time_offset is not a number");
  if (!std::isfinite(rate) || rate < 0) ThrowUsage("imu: rate must not be negative");
}

ImuNoise InUse(ImuNoise noise) {
  noise.gyro = std::max(noise.gyro, 5e-4);
  noise.accel = std::max(noise.accel, 0.02);
  return noise;
}

}  // namespace alidade
