// The readings of an inertial sensor between two times as one measurement of relative motion, which
// depends on neither the pose nor the velocity at its start (Forster, Carlone, Dellaert &
// Scaramuzza 2017, §VI).
#pragma once

#include <Eigen/Core>
#include <span>

#include "alidade/inertial/imu.h"

namespace ALIDADE_API alidade {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Matrix96d = Eigen::Matrix<double, 9, 6>;

struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   // rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  // m/s²
};

// Motion of the sensor at one time.
struct InertialState {
  Se3 T_world_imu;                                     // metres
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the sensor, in the world, m/s
  ImuBias bias;
};

// From time i to time j, with R, v, p the rotation, velocity and position of the sensor in the
// world and g the gravity (length 9.81, downwards):
//   R_j = R_i dR,  v_j = v_i + g t + R_i dv,  p_j = p_i + v_i t + g t²/2 + R_i dp.
struct Preintegration {
  double seconds = 0;  // t
  ImuBias bias;        // that was subtracted from the readings
  Eigen::Matrix3d dR = Eigen::Matrix3d::Identity();
  Eigen::Vector3d dv = Eigen::Vector3d::Zero(), dp = Eigen::Vector3d::Zero();
  // Error vector: (rotation; velocity; position), with dR Exp(rotation), all in the axes of i.
  Matrix9d covariance = Matrix9d::Zero();  // from the white noise
  Matrix96d by_bias = Matrix96d::Zero();   // derivative of the error vector by (gyro; accel) bias

  // Appends `seconds` of the readings `angular_rate` and `specific_force`, taken at the middle of
  // that time; bias not subtracted yet. Second order in `seconds`.
  void Append(double seconds, const Eigen::Vector3d& angular_rate,
              const Eigen::Vector3d& specific_force, const ImuNoise& noise);
  // This motion and then `next`; the bias is that of this one.
  Preintegration Then(const Preintegration& next) const;
  // The same readings with another bias, by the first derivatives (eq. 44).
  Preintegration WithBias(const ImuBias& other) const;
};

// Of `samples` (in order of time) from time `from` to time `to`, seconds. Readings between samples
// are interpolated linearly; before the first and after the last one they are that one's. Where
// there is none for more than 0.2 s, the covariance is that of a sensor that is moved by hand.
Preintegration Preintegrate(std::span<const ImuSample> samples, double from, double to,
                            const ImuBias& bias, const ImuNoise& noise);

// Rotation from time `from` to time `to` by the gyroscope alone, as above: Preintegration::dR
// without its derivatives.
Eigen::Matrix3d TurnOf(std::span<const ImuSample> samples, double from, double to,
                       const Eigen::Vector3d& gyro_bias = Eigen::Vector3d::Zero());

// Whether no two successive readings between `from` and `to` are more than 0.2 s apart.
bool TellMotion(std::span<const ImuSample> samples, double from, double to);

// The reading at `time`, as above. `samples` is not empty.
ImuSample ReadingAt(std::span<const ImuSample> samples, double time);

// The state after the motion. `gravity`: in the world, m/s².
InertialState Predict(const InertialState& state, const Preintegration& motion,
                      const Eigen::Vector3d& gravity);

// Error of the motion between two states, in the order of Preintegration::covariance, with the
// bias of `i` (eq. 45), and its derivatives. Increments of a state: (rotation; velocity; position)
// with R Exp(rotation), v + velocity, p + position.
struct MotionResidual {
  Vector9d error;
  Matrix9d by_i, by_j;
  Matrix96d by_bias;
  Eigen::Matrix<double, 9, 3> by_gravity;
};
MotionResidual ResidualOf(const InertialState& i, const InertialState& j,
                          const Preintegration& motion, const Eigen::Vector3d& gravity);

// Right Jacobian of SO(3) and its inverse: Exp(v + dv) = Exp(v) Exp(Jr dv).
Eigen::Matrix3d RightJacobian(const Eigen::Vector3d& rotation_vector);
Eigen::Matrix3d InverseRightJacobian(const Eigen::Vector3d& rotation_vector);

}  // namespace alidade
