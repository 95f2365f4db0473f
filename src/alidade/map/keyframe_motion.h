// The motion of the camera between two keyframes, as an inertial sensor tells it.
#pragma once

#include "alidade/base/api.h"
#include "alidade/base/ids.h"
#include "alidade/inertial/preintegration.h"

namespace ALIDADE_API alidade {

struct KeyFrameMotion {
  KeyFrameId since;       // the keyframe before, in time; alive, or its map was split
  Preintegration motion;  // of the sensor, from that keyframe to this one
  Se3 T_camera_imu;
  // Standard deviations of the components of motion.bias, rad/s and m/s².
  double gyro_bias_sigma = 0, accel_bias_sigma = 0;
  double accel_walk = 0;    // density of the random walk of the accelerometer's bias, m/s³/√Hz
  double noise_factor = 1;  // of the noise in `motion`: InertialFit::noise_factor
};

}  // namespace alidade
