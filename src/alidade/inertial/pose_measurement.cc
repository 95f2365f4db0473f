#include "alidade/inertial/pose_measurement.h"

namespace alidade {

Eigen::Matrix<double, 3, 2> TangentsOf(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d a = direction.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> B;
  B << a, direction.cross(a);
  return B;
}

void CommonParameters::Increase(const ChainSystem::CommonVector& step) {
  scale *= 1 + step(kScale);
  model.T_camera_imu.R = model.T_camera_imu.R * ExpSo3(step.segment<3>(kTurn));
  model.T_camera_imu.t += step.segment<3>(kArm);
  model.time_offset += step(kOffset);
  const Eigen::Vector3d tilt = TangentsOf(down) * step.segment<2>(kTilt);
  down = ExpSo3(tilt) * down;
}

void Increase(InertialState& state, const ChainSystem::StateVector& step,
              const ChainSystem::CommonVector& common_step, const CommonParameters& common,
              const ImuSample& reading) {
  const double growth = 1 + common_step(kScale), later = common_step(kOffset);
  state.T_world_imu.R = state.T_world_imu.R * ExpSo3(step.head<3>());
  state.velocity = growth * state.velocity + step.segment<3>(3);
  state.T_world_imu.t = growth * state.T_world_imu.t + step.segment<3>(6);
  state.bias.gyro += step.segment<3>(9);
  state.bias.accel += step.segment<3>(12);
  const Eigen::Matrix3d R = state.T_world_imu.R;
  state.T_world_imu.R = R * ExpSo3(later * (reading.angular_rate - state.bias.gyro));
  state.T_world_imu.t += later * state.velocity;
  state.velocity +=
      later * (kGravity * common.down + R * (reading.specific_force - state.bias.accel));
}

PoseMeasurement MeasurementOf(const InertialState& state, const CommonParameters& common,
                              const Se3& measured, const Eigen::Vector3d& angular_rate) {
  const Se3& T_camera_imu = common.model.T_camera_imu;
  const double scale = common.scale;
  const Se3 T_world_camera = state.T_world_imu * T_camera_imu.Inverse();
  const Eigen::Matrix3d Rm_t = measured.R.transpose();
  const Eigen::Matrix3d& R = T_world_camera.R;
  const Eigen::Matrix3d& R_ci = T_camera_imu.R;
  const Eigen::Vector3d rate = angular_rate - state.bias.gyro;
  PoseMeasurement m;
  m.error.head<3>() = Rm_t * (T_world_camera.t / scale - measured.t);
  m.error.tail<3>() = LogSo3(Rm_t * R);
  const Eigen::Matrix3d by_turn = InverseRightJacobian(m.error.tail<3>()) * R_ci;
  const Eigen::Matrix3d way_by_turn = Rm_t * R * Skew(T_camera_imu.t) * R_ci / scale;
  m.by_state.setZero();
  m.by_state.block<3, 3>(0, 0) = way_by_turn;
  m.by_state.block<3, 3>(0, 6) = Rm_t / scale;
  m.by_state.block<3, 3>(3, 0) = by_turn;
  m.by_common.setZero();
  m.by_common.block<3, 1>(0, kScale) = Rm_t * (state.T_world_imu.t - T_world_camera.t) / scale;
  m.by_common.block<3, 3>(0, kTurn) = -way_by_turn;
  m.by_common.block<3, 3>(3, kTurn) = -by_turn;
  m.by_common.block<3, 3>(0, kArm) = -Rm_t * R / scale;
  m.by_common.block<3, 1>(0, kOffset) = Rm_t * state.velocity / scale + way_by_turn * rate;
  m.by_common.block<3, 1>(3, kOffset) = by_turn * rate;
  return m;
}

}  // namespace alidade
