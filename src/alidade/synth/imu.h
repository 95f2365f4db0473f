// Simulated inertial sensor that is carried along with the rendered camera.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "alidade/synth/camera_path.h"
#include "alidade/synth/imu_track.h"
#include "alidade/synth/settings.h"

namespace alidade {

// Of the rendered worlds, whose z is up; m/s².
inline const Eigen::Vector3d kSynthGravity(0, 0, -9.81);

Se3 EurocCameraImu();      // T_camera_imu of EuRoC's left camera (Burri et al. 2016)
ImuNoise EurocImuNoise();  // of its sensor, an ADIS16448

// What a perfect sensor at `T_camera_imu` reads; its time is that of the motion, seconds. Exact:
// the lever arm adds centripetal and angular acceleration.
ImuSample PerfectReading(const PathMotion& motion, const Se3& T_camera_imu, double time);

// A sensor's errors. All random numbers are of streams of their own: pictures are the same with and
// without a sensor.
struct ImuErrors {
  ImuNoise noise;  // simulated if `noisy`
  bool noisy = false;
  ImuBias bias;           // at time 0; from there it wanders
  double jitter = 0;      // seconds; stamps are wrong by up to this much, either way
  double gyro_step = 0;   // rad/s, of quantization; 0: none
  double accel_step = 0;  // m/s²
};

// A sensor with the errors of its kind; told() holds all of "adis" and "ideal", nothing of "phone".
// Readings depend on the settings and their number only.
class SimulatedImu : public ImuTrack {
 public:
  // The sensor SynthSettings::imu, which is not "off". `motion`: of the camera at a time of the
  // images, seconds, from shortly before 0 to shortly after `seconds`.
  SimulatedImu(const SynthSettings& settings, double seconds,
               std::function<PathMotion(double)> motion);

  ImuBias BiasAt(double time) const override;
  std::vector<ImuSample> Between(double after, double until) const override;

 private:
  ImuSample Reading(long number) const;

  std::function<PathMotion(double)> motion_;
  ImuErrors errors_;
  uint64_t seed_;
  std::vector<ImuBias> walk_;  // of the bias, at every kWalkStep seconds
};

}  // namespace alidade
