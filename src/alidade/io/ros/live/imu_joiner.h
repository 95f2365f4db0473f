// Live readings of a gyroscope and an accelerometer that are published apart.
#pragma once

#include <vector>

#include "alidade/inertial/imu.h"

namespace alidade {

// One thread. Readings of each sensor come in order of time; later ones that are older are dropped.
class ImuJoiner {
 public:
  void AddRate(double time, const Eigen::Vector3d& angular_rate);     // seconds, rad/s
  void AddForce(double time, const Eigen::Vector3d& specific_force);  // seconds, m/s²
  // The gyroscope's readings since the last call up to the newest acceleration, with the
  // accelerations interpolated at their times (OnOneClock()).
  std::vector<ImuSample> Take();

 private:
  std::vector<ImuSample> rates_, forces_;  // each has half of a reading
};

}  // namespace alidade
