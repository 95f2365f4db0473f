// Readings of an inertial sensor (IMU: gyroscope and accelerometer), and the sensor itself.
#pragma once

#include <Eigen/Core>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// One reading, in the axes of the sensor.
struct ImuSample {
  double time = 0;                                         // seconds
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  // rad/s
  // Specific force, m/s²: acceleration minus gravity. At rest it points up and is 9.81 long.
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();
};

// Noise of a sensor, as continuous-time densities (of white noise n and of the random walk of the
// bias b: reading = truth + b + n). Defaults: the sensor of a phone, on the safe side.
struct ImuNoise {
  double gyro = 1e-3;        // rad/s/√Hz
  double accel = 1e-2;       // m/s²/√Hz
  double gyro_walk = 1e-4;   // rad/s²/√Hz
  double accel_walk = 1e-3;  // m/s³/√Hz
};

// What is known of a sensor that is fixed to the camera.
struct ImuModel {
  // Pose of the sensor in the (left, rectified) camera's frame.
  Se3 T_camera_imu;
  bool rotation_known = false;  // T_camera_imu.R is given; else it is estimated
  bool translation_known =
      false;  // T_camera_imu.t is given; else it is within a few centimetres of 0
  // An image taken at t on its own clock was taken at t + time_offset on the clock of the samples,
  // seconds.
  double time_offset = 0;
  bool time_offset_known = false;  // else it is estimated
  double rate = 0;                 // samples per second; 0: unknown
  // Data sheets are of a sensor at rest: what is assumed is not below the noise of one that shakes
  // (InUse()).
  ImuNoise noise;
  void Check() const;  // throws Error (usage) naming the value that cannot be
};

// The noise that readings of a moving sensor are given: at least 0.02 m/s²/√Hz and 5e-4 rad/s/√Hz.
// It covers vibration, scale factors, and axes that are not quite perpendicular, which data sheets
// of a sensor at rest leave out
// (docs/development/decisions/0035-inertial-fit.md).
ImuNoise InUse(ImuNoise noise);

}  // namespace alidade
