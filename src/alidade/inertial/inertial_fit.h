// What a camera's trajectory and the readings of an inertial sensor tell together: scale, gravity,
// velocities, biases, and where the sensor sits and how its clock is offset.
//
// Maximum a posteriori over a chain of states, one per pose (Campos, Montiel & Tardós 2020, §III,
// extended): poses of the camera up to a scale are measurements with a covariance, as in
// loosely coupled fusion, and the states are free, so that the covariances of the results contain
// the errors of vision. Biases walk from state to state.
#pragma once

#include <span>
#include <vector>

#include "alidade/inertial/imu.h"
#include "alidade/inertial/motion_belief.h"
#include "alidade/inertial/preintegration.h"

namespace ALIDADE_API alidade {

// What is believed before, as standard deviations.
struct InertialPriors {
  double scale = 0;              // of the map's unit being a meter, relative; 0: nothing is known
  ImuBias bias;                  // of the first state; the next two are deviations from it
  double gyro_bias = 0.1;        // rad/s: sensors of robots have up to 0.08
  double accel_bias = 0.3;       // m/s²: phones have 0.15
  double rotation_known = 3e-3;  // rad: a calibrated rotation of the sensor
  double translation_known = 5e-3;  // m: a calibrated place of the sensor
  double translation = 0.05;        // m, of zero: phones
  double time_offset_known = 1e-3;  // s
  double time_offset = 0.05;        // s, of zero: phones
  void Check() const;               // throws Error (usage) naming the field that cannot be
};

struct InertialFit {
  bool solved = false;     // false: too few poses or readings, or the solution is not a minimum
  double scale = 1;        // meters per map unit
  double scale_sigma = 0;  // relative
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  // in the world of the poses, m/s²
  double gravity_sigma = 0;                           // of its direction, radians
  // At the times of the poses. T_world_imu is in the world of the poses, in meters.
  std::vector<InertialState> states;
  ImuModel model;                // with what was estimated of it
  double rotation_sigma = 0;     // of model.T_camera_imu.R, radians, largest axis
  double translation_sigma = 0;  // m
  double time_offset_sigma = 0;  // s
  double gyro_bias_sigma = 0, accel_bias_sigma = 0;  // of the last state, rad/s, m/s², largest axis
  MotionBelief first, last;                          // of the states at the first and the last pose
  // Square root of the mean squared normalized residual: 1 where noise and covariances are right.
  // The standard deviations above are multiplied by it when it is above 1.
  double noise_factor = 1;
};

// A fit is used when it explains the poses (above this noise factor the model is wrong) and tells
// the scale to 5 % and gravity to 2 degrees.
inline constexpr double kMostNoiseFactor = 6;
inline constexpr double kMostScaleSigma = 0.05;     // relative
inline constexpr double kMostGravitySigma = 0.035;  // radians

// Covariance of the errors that poses of a map have in common, which the covariance of one pose
// against the map does not contain: 1.5 per mille of `distance`, that of what is seen (map units),
// and 0.7 mrad.
Matrix6d CommonErrors(double distance);

// `poses` and `samples` in order of time; poses at least two. Not more than some hundred poses, a
// few per second, over less than a minute: one scale holds for all of them. `start`: a former
// result for about the same poses, or null. Throws Error (usage) if a prior cannot be.
InertialFit FitInertial(std::span<const TimedPose> poses, std::span<const ImuSample> samples,
                        const ImuModel& model, const InertialPriors& priors = {},
                        const InertialFit* start = nullptr);

}  // namespace alidade
