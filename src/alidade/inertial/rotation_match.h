// Rotation between camera and inertial sensor and offset of their clocks, from their rotations
// alone.
#pragma once

#include <span>

#include "alidade/inertial/inertial_fit.h"

namespace ALIDADE_API alidade {

struct RotationMatch {
  Eigen::Matrix3d R_camera_imu = Eigen::Matrix3d::Identity();
  double time_offset = 0;                               // ImuModel::time_offset, seconds
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  // rad/s
  // Root mean square of the camera's angular rate between two poses, and of what the gyroscope
  // leaves of it, rad/s.
  double turning = 0, residual = 0;
  // Second singular value of the correlation, relative to the first: near zero when the camera
  // turned about one axis only, and the rotation about it is unknown.
  double second_axis = 0;
  // Standard deviations where errors of the rates are independent: of R_camera_imu about its least
  // known axis, radians, and of time_offset, seconds. 0: given.
  double rotation_sigma = 0, time_offset_sigma = 0;
  bool ok = false;

  // The camera turned enough (0.1 rad/s) to compare rotations.
  bool Tells() const { return ok && turning >= 0.1; }
  // The gyroscope explains less than half of how the camera turned.
  bool Contradicts() const { return Tells() && residual >= 0.5 * turning; }
};

// Angular rates w_camera = R_camera_imu (w_imu - bias) between successive poses, by least squares:
// rotation and bias in closed form (Umeyama 1991), the offset by search within ±`longest_offset`
// seconds around the model's. What the model knows is kept.
RotationMatch MatchRotations(std::span<const TimedPose> poses, std::span<const ImuSample> samples,
                             const ImuModel& model, double longest_offset = 0.12);

// How well a gyroscope of which all is known turned as the camera did.
RotationMatch CompareRotations(std::span<const TimedPose> poses, std::span<const ImuSample> samples,
                               const ImuModel& model, const Eigen::Vector3d& gyro_bias);

}  // namespace alidade
