// What inertial readings tell of a finished trajectory: FitInertial() over windows of it.
#pragma once

#include <string>
#include <vector>

#include "alidade/inertial/inertial_fit.h"
#include "alidade/io/trajectory.h"

namespace alidade {

// What was found, from all windows together. Standard deviations contain the scatter between them.
struct InertialFinding {
  std::string why_not;     // why scale and gravity are not known, with figures; empty: they are
  double scale = 1;        // meters per unit of the trajectory
  double scale_sigma = 0;  // relative
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();  // unit vector in the trajectory's world
  double down_sigma = 0;                            // radians
  ImuModel model;                                   // with what was estimated
  double rotation_sigma = 0;                        // radians; 0: given
  double translation_sigma = 0;                     // meters; 0: given
  double time_offset_sigma = 0;                     // seconds; 0: given
  ImuBias bias;                                     // mean of the windows
  // Standard deviation of that mean (gyroscope, accelerometer), from the scatter between at least
  // two windows; zero: unknown.
  Vector6d bias_sigma = Vector6d::Zero();
  double noise_factor = 0;      // InertialFit::noise_factor, largest
  int windows = 0, solved = 0;  // windows tried, and used
};

struct WindowSettings {
  bool meters = false;  // lengths of the trajectory are meters
  double distance = 1;  // of what the camera sees, in units of the trajectory: for their errors
  double seconds = 20;  // of a window
};

// `trajectory` in order of time; `samples` cleaned (ImuStream) and in order of time. Throws Error
// (input) if the readings do not cover the trajectory.
InertialFinding FindInertial(const Trajectory& trajectory, const std::vector<ImuSample>& samples,
                             const ImuModel& model, const WindowSettings& settings);

}  // namespace alidade
