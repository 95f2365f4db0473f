// A camera's pose as a measurement of the state of an inertial sensor, and the parameters that all
// states have in common: shared by the fit over a chain of states and the belief about one.
#pragma once

#include <Eigen/Core>

#include "alidade/inertial/chain_system.h"
#include "alidade/inertial/preintegration.h"

namespace ALIDADE_API alidade {

inline constexpr double kGravity = 9.81;  // m/s²; it varies by 0.3 % over the earth

struct TimedPose {
  double time = 0;     // of the image, seconds
  Se3 T_world_camera;  // map units
  // T_world_camera * Exp(xi) is the true pose, xi = (translation; rotation) ~ N(0, covariance).
  Matrix6d covariance = Matrix6d::Zero();
};

// Order of a state's increment: (rotation; velocity; position; gyro bias; accel bias).
// Order of the increment of the common parameters. That of the scale is relative, and positions and
// velocities of all states grow with it: positions are known well in map units, so that the
// increments are nearly independent and the residuals linear in the scale. With the clock's offset
// all states move on to the later time.
inline constexpr int kScale = 0, kTilt = 1, kTurn = 3, kArm = 6, kOffset = 9;

struct CommonParameters {
  ImuModel model;
  double scale = 1;                                 // meters per map unit
  Eigen::Vector3d down = Eigen::Vector3d::UnitZ();  // of gravity, in the world
  void Increase(const ChainSystem::CommonVector& step);
};

// Two unit vectors perpendicular to `direction`, as columns. The increment of a tilt is a rotation
// vector in their plane.
Eigen::Matrix<double, 3, 2> TangentsOf(const Eigen::Vector3d& direction);

// `common`: before its own increment; `reading`: at the time of the state.
void Increase(InertialState& state, const ChainSystem::StateVector& step,
              const ChainSystem::CommonVector& common_step, const CommonParameters& common,
              const ImuSample& reading);

// Error (translation; rotation) of the camera's pose T_world_imu T_camera_imu⁻¹ against a measured
// one, in map units and in the axes of the measured camera, and its derivatives.
struct PoseMeasurement {
  Vector6d error;
  Eigen::Matrix<double, 6, ChainSystem::kState> by_state;
  Eigen::Matrix<double, 6, ChainSystem::kCommon> by_common;
};
// `angular_rate`: the reading at that time, bias not subtracted.
PoseMeasurement MeasurementOf(const InertialState& state, const CommonParameters& common,
                              const Se3& T_world_camera, const Eigen::Vector3d& angular_rate);

}  // namespace alidade
