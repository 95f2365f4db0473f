// An inertial sensor's readings during a rendered recording.
#pragma once

#include <vector>

#include "alidade/inertial/imu.h"
#include "alidade/inertial/preintegration.h"

namespace alidade {

class ImuTrack {
 public:
  virtual ~ImuTrack() = default;
  // What a user knows of the sensor.
  const ImuModel& told() const { return told_; }
  // What it is: true rotation, lever arm, offset of the clock, noise.
  const ImuModel& truth() const { return truth_; }
  // True bias at a time on the clock of the images, seconds; 0 where nobody knows it.
  virtual ImuBias BiasAt(double time) const = 0;
  // Readings with after < time <= until, both on the clock of the samples, in order of time.
  virtual std::vector<ImuSample> Between(double after, double until) const = 0;

 protected:
  ImuModel told_, truth_;
};

}  // namespace alidade
