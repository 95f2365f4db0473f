#include "alidade/io/files/imu_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/nearest_name.h"
#include "alidade/inertial/imu_stream.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/file.h"
#include "alidade/io/imu_table.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr double kMostTimeOffset = 10;  // seconds; more is another clock

// `value` stays where `key` is missing.
void ReadPositive(const YamlFile& file, const YAML::Node& parent, const char* key, double& value) {
  const YAML::Node node = parent[key];
  if (!node) return;
  value = file.Number(node, key);
  if (!(value > 0)) file.Fail(node, std::string("`") + key + "` must be positive");
}

ImuModel ReadEurocSensor(const std::string& path, const std::optional<Se3>& T_body_camera) {
  const YamlFile file(path);
  const YAML::Node& root = file.root();
  ImuModel model;
  ReadPositive(file, root, "rate_hz", model.rate);
  ReadPositive(file, root, "gyroscope_noise_density", model.noise.gyro);
  ReadPositive(file, root, "gyroscope_random_walk", model.noise.gyro_walk);
  ReadPositive(file, root, "accelerometer_noise_density", model.noise.accel);
  ReadPositive(file, root, "accelerometer_random_walk", model.noise.accel_walk);
  const YAML::Node T_BS = root["T_BS"];
  if (T_BS && T_body_camera) {
    const Se3 T_body_imu = file.Transform(T_BS.IsMap() ? file.Need(T_BS, "data") : T_BS, "T_BS");
    model.T_camera_imu = T_body_camera->Inverse() * T_body_imu;
    model.rotation_known = model.translation_known = true;
  }
  return model;
}

// Safari's accelerations have the opposite sign of all other browsers'.
bool IsOfSafari(const std::string& motion_file) {
  const std::string device = (fs::path(motion_file).parent_path() / "device.json").string();
  if (fs::path(motion_file).filename() != "motion.csv" || !IsFile(device)) return false;
  const std::string text = ReadFile(device, kMostConfigBytes);
  for (const char* name : {"iPhone", "iPad", "Macintosh"}) {
    if (text.find(name) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

std::optional<ImuRecording> CleanImu(ImuRecording imu, const std::string& name) {
  ImuStream stream;
  imu.samples = stream.Add(std::move(imu.samples));
  for (const std::string& odd : stream.News()) LogWarning(name + ": " + odd);
  std::string problem = stream.broken();
  if (problem.empty() && imu.samples.size() < 2)
    problem = "there are no inertial readings that can be used";
  if (!problem.empty()) {
    LogWarning(name + ": " + problem);
    return std::nullopt;
  }
  if (imu.model.rate <= 0) imu.model.rate = stream.rate();
  return imu;
}

std::optional<ImuRecording> ReadImuFile(const std::string& path, std::string* told) {
  ImuTable table = ParseImuTable(ReadFile(path), path);
  *told = table.told;
  ImuRecording imu;
  imu.samples = std::move(table.samples);
  if (IsOfSafari(path)) {
    for (ImuSample& sample : imu.samples) sample.specific_force *= -1;
  }
  return CleanImu(std::move(imu), path);
}

std::string ImuFileBeside(const std::string& recording) {
  const std::vector<std::string> names =
      IsFolder(recording) ? std::vector{recording + "/imu.csv", recording + "/motion.csv"}
                          : std::vector{recording + ".imu.csv"};
  for (const std::string& name : names) {
    if (IsFile(name)) return name;
  }
  return {};
}

std::optional<ImuRecording> ReadEurocImu(const std::string& folder,
                                         const std::optional<Se3>& T_body_camera) try {
  const std::string data = folder + "/data.csv", sensor = folder + "/sensor.yaml";
  ImuRecording imu;
  if (IsThere(sensor)) imu.model = ReadEurocSensor(sensor, T_body_camera);
  imu.model.time_offset_known = true;  // EuRoC's cameras and sensor share one clock
  ImuTable table = ParseImuTable(ReadFile(data), data, StampUnit::kNanoseconds);
  if (!table.told.empty()) LogWarning(table.told);
  imu.samples = std::move(table.samples);
  return CleanImu(std::move(imu), data);
} catch (const Error& error) {
  LogWarning(std::string(error.what()) + "; the inertial readings are left out");
  return std::nullopt;
}

ImuModel ImuModelOf(const YamlFile& file, const YAML::Node& imu) {
  if (!imu.IsMap()) file.Fail(imu, "`imu` must contain the names and values of a sensor");
  static const std::vector<std::string> kKeys = {"T_camera_imu", "R_camera_imu", "rate",
                                                 "gyro_noise",   "accel_noise",  "gyro_walk",
                                                 "accel_walk",   "time_offset"};
  for (const auto& entry : imu) {
    const std::string key = entry.first.Scalar();
    if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end())
      file.Fail(entry.first, "`" + key + "` is not known in `imu`" + DidYouMean(key, kKeys));
  }
  ImuModel model;
  if (const YAML::Node T = imu["T_camera_imu"]) {
    model.T_camera_imu = file.Transform(T, "T_camera_imu");
    model.rotation_known = model.translation_known = true;
  }
  if (const YAML::Node R = imu["R_camera_imu"]) {
    const std::vector<double> v = file.Numbers(R, "R_camera_imu");
    if (v.size() != 9) file.Fail(R, "`R_camera_imu` must be 9 numbers, the rows of a rotation");
    if (model.rotation_known)
      file.Fail(R, "`R_camera_imu` is for a sensor whose place is unknown: not with T_camera_imu");
    model.T_camera_imu =
        file.Transform(R, "R_camera_imu",
                       {v[0], v[1], v[2], 0, v[3], v[4], v[5], 0, v[6], v[7], v[8], 0, 0, 0, 0, 1});
    model.rotation_known = true;
  }
  ReadPositive(file, imu, "rate", model.rate);
  ReadPositive(file, imu, "gyro_noise", model.noise.gyro);
  ReadPositive(file, imu, "accel_noise", model.noise.accel);
  ReadPositive(file, imu, "gyro_walk", model.noise.gyro_walk);
  ReadPositive(file, imu, "accel_walk", model.noise.accel_walk);
  if (const YAML::Node offset = imu["time_offset"]) {
    model.time_offset = file.Number(offset, "time_offset");
    model.time_offset_known = true;
    if (std::abs(model.time_offset) > kMostTimeOffset)
      file.Fail(offset, "`time_offset` is in seconds, and at most 10");
  }
  return model;
}

std::optional<ImuModel> ReadImuModel(const std::string& camera_file) try {
  const std::string path = CameraFilePath(camera_file);
  const YamlFile file(ReadFile(path, kMostCalibrationBytes), path);
  const YAML::Node imu = file.root()["imu"];
  // Other tools have blocks of this name: theirs has a camera of its own (Kalibr, Basalt).
  if (!imu || !file.root()["model"] || !file.root()["fx"]) return std::nullopt;
  return ImuModelOf(file, imu);
} catch (const Error&) {  // told, with what it is, when the camera is read
  return std::nullopt;
} catch (const YAML::Exception&) {
  return std::nullopt;
}

}  // namespace alidade
