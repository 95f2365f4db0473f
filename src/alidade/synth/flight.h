// A given path of the camera, with the readings of the inertial sensor that was carried along it.
#pragma once

#include <vector>

#include "alidade/inertial/imu.h"
#include "alidade/synth/imu_track.h"

namespace alidade {

struct FlightPose {
  double time = 0;  // seconds
  Se3 T_world_camera;
};

struct Flight {
  std::vector<FlightPose> poses;    // in order of time; images are taken at them. z is up
  std::vector<ImuSample> readings;  // in order of time, on the same clock; may be empty
  ImuModel imu;                     // what is known of the sensor
  // Throws Error (usage): fewer than two poses, or times not in order.
  void Check() const;
  double Fps() const;  // images per second, from the median interval
};

// The path between the poses: cubic, with continuous velocity and angular rate. Before the first
// and after the last pose it stands.
class FlightPath {
 public:
  explicit FlightPath(std::vector<FlightPose> poses);  // two or more, in order of time
  Se3 At(double time) const;                           // T_world_camera

 private:
  std::vector<FlightPose> poses_;
  // At the poses: in the world, m/s, and in the camera's axes, rad/s.
  std::vector<Eigen::Vector3d> velocity_, angular_rate_;
};

// The readings that were recorded.
class RecordedImu : public ImuTrack {
 public:
  RecordedImu(std::vector<ImuSample> readings, const ImuModel& model);
  std::vector<ImuSample> Between(double after, double until) const override;
  ImuBias BiasAt(double) const override { return {}; }

 private:
  std::vector<ImuSample> readings_;
};

}  // namespace alidade
