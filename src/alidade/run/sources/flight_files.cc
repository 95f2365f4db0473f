#include "alidade/run/sources/flight_files.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/inertial/rotation_match.h"
#include "alidade/io/files/imu_file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/io/files/yaml.h"
#include "alidade/synth/imu.h"

namespace alidade {
namespace {

ImuModel ReadModel(const std::string& path) {
  ImuModel model;
  model.T_camera_imu = EurocCameraImu();
  model.noise = EurocImuNoise();
  model.rotation_known = model.translation_known = model.time_offset_known = true;
  if (path.empty()) return model;
  const YamlFile file(path);
  const YAML::Node T_BS = file.Need(file.root(), "T_BS");
  model.T_camera_imu =
      file.Transform(T_BS.IsMap() ? file.Need(T_BS, "data") : T_BS, "T_BS").Inverse();
  for (const auto& [key, value] :
       {std::pair("gyroscope_noise_density", &model.noise.gyro),
        std::pair("gyroscope_random_walk", &model.noise.gyro_walk),
        std::pair("accelerometer_noise_density", &model.noise.accel),
        std::pair("accelerometer_random_walk", &model.noise.accel_walk)}) {
    if (const YAML::Node node = file.root()[key]) *value = file.Number(node, key);
  }
  return model;
}

// RotationMatch::residual, rad/s.
double TurnsApart(const Flight& flight, const std::vector<FlightPose>& poses) {
  std::vector<TimedPose> timed;
  for (const FlightPose& pose : poses)
    timed.push_back({pose.time, pose.T_world_camera, Matrix6d::Zero()});
  return MatchRotations(timed, flight.readings, flight.imu).residual;
}

// The same file with its quaternions read as w x y z of the rotation T_camera_world.
std::vector<FlightPose> ReadTheOtherWay(std::vector<FlightPose> poses) {
  for (FlightPose& pose : poses) {
    const Eigen::Quaterniond q = pose.T_world_camera.Quaternion();
    pose.T_world_camera.R = Eigen::Quaterniond(q.x(), -q.y(), -q.z(), -q.w()).toRotationMatrix();
  }
  return poses;
}

// Paths are known to be written with other quaternions than the format's; the gyroscope tells.
void CheckQuaternions(const SynthSettings& settings, Flight& flight) {
  constexpr double kAgree = 0.1;  // rad/s; a drone's vibration and rounded poses stay below
  const double apart = TurnsApart(flight, flight.poses);
  if (apart < kAgree) return;
  std::vector<FlightPose> other = ReadTheOtherWay(flight.poses);
  if (TurnsApart(flight, other) < std::min(kAgree, apart / 4)) {
    LogWarning(settings.path +
               ": as qx qy qz qw of T_world_camera the quaternions contradict the gyroscope; they "
               "are read as qw qx qy qz of T_camera_world, with which it agrees");
    flight.poses = std::move(other);
    return;
  }
  LogWarning(settings.imu + " contradicts the turns of " + settings.path +
             ": is it of another sensor, or the sensor mounted otherwise?");
}

}  // namespace

Flight ReadFlight(const SynthSettings& settings) {
  Flight flight;
  for (const StampedPose& pose : ReadTrajectory(settings.path))
    flight.poses.push_back({pose.time, pose.T_world_camera});
  flight.imu = ReadModel(settings.imu_model);
  if (settings.imu == "off") return flight;
  std::string told;
  std::optional<ImuRecording> readings = ReadImuFile(settings.imu, &told);
  if (!readings || readings->samples.size() < 2)
    ThrowInput(settings.imu + " has no inertial readings that can be used");
  if (!told.empty()) LogWarning(told);
  flight.readings = std::move(readings->samples);
  flight.imu.rate = readings->model.rate;
  if (flight.readings.front().time > flight.poses.back().time ||
      flight.readings.back().time < flight.poses.front().time)
    ThrowInput(settings.imu + " and " + settings.path + " have no time in common");
  flight.Check();
  CheckQuaternions(settings, flight);
  return flight;
}

}  // namespace alidade
