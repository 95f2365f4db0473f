#include "alidade/inertial/motion_belief.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace alidade {

MotionBelief MotionBelief::At(double to, std::span<const ImuSample> samples) const {
  if (!(to > time) || samples.empty()) return *this;
  const ImuNoise noise = InUse(common.model.noise);
  const double offset = common.model.time_offset;
  const Preintegration motion =
      Preintegrate(samples, time + offset, to + offset, state.bias, noise);
  const double t = motion.seconds;
  const Eigen::Matrix3d& R = state.T_world_imu.R;
  const Eigen::Vector3d gravity = kGravity * common.down;

  Matrix F = Matrix::Identity();
  F.block<3, 3>(0, 0) = motion.dR.transpose();
  F.block<3, 3>(3, 0) = -R * Skew(motion.dv);
  F.block<3, 3>(6, 0) = -R * Skew(motion.dp);
  F.block<3, 3>(6, 3) = t * Eigen::Matrix3d::Identity();
  F.block<3, 6>(0, 9) = motion.by_bias.topRows<3>();
  F.block<3, 6>(3, 9) = R * motion.by_bias.middleRows<3>(3);
  F.block<3, 6>(6, 9) = R * motion.by_bias.bottomRows<3>();
  const Eigen::Matrix<double, 3, 2> by_tilt =
      -kGravity * Skew(common.down) * TangentsOf(common.down);
  F.block<3, 2>(3, kState + kTilt) = t * by_tilt;
  F.block<3, 2>(6, kState + kTilt) = t * t / 2 * by_tilt;
  // Positions and velocities grow with the scale; what the readings tell is in meters anyway.
  F.block<3, 1>(3, kState + kScale) = -(gravity * t + R * motion.dv);
  F.block<3, 1>(6, kState + kScale) = -(gravity * (t * t / 2) + R * motion.dp);

  Matrix9d into_world = Matrix9d::Identity();
  into_world.block<3, 3>(3, 3) = into_world.block<3, 3>(6, 6) = R;
  MotionBelief next = *this;
  next.time = to;
  next.state = Predict(state, motion, gravity);
  next.covariance = F * covariance * F.transpose();
  next.covariance.topLeftCorner<9, 9>() += into_world * motion.covariance * into_world.transpose();
  next.covariance.diagonal().segment<3>(9).array() += noise.gyro_walk * noise.gyro_walk * t;
  next.covariance.diagonal().segment<3>(12).array() += noise.accel_walk * noise.accel_walk * t;
  return next;
}

Se3 MotionBelief::T_world_camera() const {
  Se3 T = state.T_world_imu * common.model.T_camera_imu.Inverse();
  T.t /= common.scale;
  return T;
}

TimedPose MotionBelief::Camera(std::span<const ImuSample> samples) const {
  TimedPose pose;
  pose.time = time;
  pose.T_world_camera = T_world_camera();
  const Eigen::Vector3d rate = ReadingAt(samples, time + common.model.time_offset).angular_rate;
  const PoseMeasurement m = MeasurementOf(state, common, pose.T_world_camera, rate);
  Eigen::Matrix<double, 6, kSize> H;
  H << m.by_state, m.by_common;
  pose.covariance = H * covariance * H.transpose();
  return pose;
}

bool MotionBelief::See(const TimedPose& pose, std::span<const ImuSample> samples) {
  const ImuSample reading = ReadingAt(samples, time + common.model.time_offset);
  const PoseMeasurement m = MeasurementOf(state, common, pose.T_world_camera, reading.angular_rate);
  Eigen::Matrix<double, 6, kSize> H;
  H << m.by_state, m.by_common;
  const Eigen::LLT<Matrix6d> innovation(H * covariance * H.transpose() + pose.covariance);
  if (innovation.info() != Eigen::Success || !m.error.allFinite()) return false;
  const Eigen::Matrix<double, 6, kSize> gain_t = innovation.solve(H * covariance);
  const Eigen::Matrix<double, kSize, 1> step = -gain_t.transpose() * m.error;
  // Joseph's form keeps the covariance positive.
  const Matrix kept = Matrix::Identity() - gain_t.transpose() * H;
  covariance = kept * covariance * kept.transpose() + gain_t.transpose() * pose.covariance * gain_t;
  const Eigen::Vector3d down = common.down;
  Increase(state, step.head<kState>(), step.tail<kCommon>(), common, reading);
  common.Increase(step.tail<kCommon>());
  Matrix other_axes = Matrix::Identity();
  other_axes.block<2, 2>(kState + kTilt, kState + kTilt) =
      TangentsOf(common.down).transpose() * TangentsOf(down);
  covariance = other_axes * covariance * other_axes.transpose();
  return true;
}

void MotionBelief::Move(const Se3& other) {
  // Orthonormal again: where T undoes a move, an error of the rotation comes back three times.
  const Se3 T = other.Normalised();
  const Eigen::Vector3d down = common.down;
  state.T_world_imu = (T * state.T_world_imu).Normalised();
  state.velocity = T.R * state.velocity;
  common.down = (T.R * common.down).normalized();
  Matrix other_axes = Matrix::Identity();
  other_axes.block<3, 3>(3, 3) = other_axes.block<3, 3>(6, 6) = T.R;
  other_axes.block<2, 2>(kState + kTilt, kState + kTilt) =
      TangentsOf(common.down).transpose() * T.R * TangentsOf(down);
  covariance = other_axes * covariance * other_axes.transpose();
}

}  // namespace alidade
