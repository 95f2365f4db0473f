#include "alidade/run/sources/flight_files.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/io/files/yaml.h"
#include "alidade/io/text.h"
#include "alidade/synth/imu.h"

namespace alidade {
namespace {

std::vector<ImuSample> ReadReadings(const std::string& path) {
  const std::string text = ReadFile(path);
  CheckIsText(text, path);
  std::vector<ImuSample> samples;
  for (const TextLine& line : ContentLines(text)) {
    std::vector<double> numbers;
    for (const std::string_view field : Fields(line.text)) {
      const std::optional<double> number = ParseNumber(field);
      if (number && std::isfinite(*number)) numbers.push_back(*number);
    }
    if (numbers.size() != 7)
      ThrowInput(path + ":" + std::to_string(line.number) +
                 ": expected 7 numbers: seconds, angular rate [rad/s], specific force [m/s^2]");
    samples.push_back(
        {numbers[0], {numbers[1], numbers[2], numbers[3]}, {numbers[4], numbers[5], numbers[6]}});
  }
  if (samples.size() < 2) ThrowInput(path + " has no inertial readings");
  return samples;
}

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

// Root mean square of the rotations between poses as the path and as the gyroscope tell them,
// rad/s; without what a constant bias makes.
double TurnsApart(const std::vector<FlightPose>& poses, const std::vector<ImuSample>& readings,
                  const Eigen::Matrix3d& R_camera_imu) {
  std::vector<Eigen::Vector3d> apart;  // rad/s
  for (size_t i = 0; i + 1 < poses.size(); ++i) {
    const double from = poses[i].time, to = poses[i + 1].time;
    if (from < readings.front().time || to > readings.back().time) continue;
    const Eigen::Vector3d told =
        LogSo3(poses[i].T_world_camera.R.transpose() * poses[i + 1].T_world_camera.R);
    const Eigen::Vector3d read = LogSo3(Preintegrate(readings, from, to, {}, {}).dR);
    apart.push_back((told - R_camera_imu * read) / (to - from));
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& each : apart) mean += each / static_cast<double>(apart.size());
  double sum = 0;
  for (const auto& each : apart) sum += (each - mean).squaredNorm();
  return apart.empty() ? 0 : std::sqrt(sum / static_cast<double>(apart.size()));
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
  const Eigen::Matrix3d& R = flight.imu.T_camera_imu.R;
  const double apart = TurnsApart(flight.poses, flight.readings, R);
  if (apart < kAgree) return;
  std::vector<FlightPose> other = ReadTheOtherWay(flight.poses);
  if (TurnsApart(other, flight.readings, R) < std::min(kAgree, apart / 4)) {
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
  flight.readings = ReadReadings(settings.imu);
  std::vector<double> intervals;
  for (size_t i = 1; i < flight.readings.size(); ++i)
    intervals.push_back(flight.readings[i].time - flight.readings[i - 1].time);
  const auto middle = intervals.begin() + static_cast<long>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  flight.imu.rate = *middle > 0 ? 1 / *middle : 0;
  if (flight.readings.front().time > flight.poses.back().time ||
      flight.readings.back().time < flight.poses.front().time)
    ThrowInput(settings.imu + " and " + settings.path + " have no time in common");
  flight.Check();
  CheckQuaternions(settings, flight);
  return flight;
}

}  // namespace alidade
