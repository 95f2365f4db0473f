#include "alidade/io/files/imu_file.h"

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/yaml.h"
#include "alidade/io/imu_table.h"

namespace alidade {
namespace {

// A key that may be missing; must be positive.
void ReadPositive(const YamlFile& file, const char* key, double& value) {
  const YAML::Node node = file.root()[key];
  if (!node) return;
  value = file.Number(node, key);
  if (!(value > 0)) file.Fail(node, std::string("`") + key + "` must be positive");
}

ImuModel ReadEurocSensor(const std::string& path, const std::optional<Se3>& T_body_camera) {
  const YamlFile file(path);
  ImuModel model;
  ReadPositive(file, "rate_hz", model.rate);
  ReadPositive(file, "gyroscope_noise_density", model.noise.gyro);
  ReadPositive(file, "gyroscope_random_walk", model.noise.gyro_walk);
  ReadPositive(file, "accelerometer_noise_density", model.noise.accel);
  ReadPositive(file, "accelerometer_random_walk", model.noise.accel_walk);
  model.time_offset_known = true;  // EuRoC's cameras and sensor share one clock
  const YAML::Node T_BS = file.root()["T_BS"];
  if (T_BS && T_body_camera) {
    const Se3 T_body_imu = file.Transform(T_BS.IsMap() ? file.Need(T_BS, "data") : T_BS, "T_BS");
    model.T_camera_imu = T_body_camera->Inverse() * T_body_imu;
    model.rotation_known = model.translation_known = true;
  }
  return model;
}

}  // namespace

std::optional<ImuRecording> ReadEurocImu(const std::string& folder,
                                         const std::optional<Se3>& T_body_camera) try {
  const std::string data = folder + "/data.csv", sensor = folder + "/sensor.yaml";
  ImuRecording imu;
  if (IsThere(sensor)) imu.model = ReadEurocSensor(sensor, T_body_camera);
  ImuTable table = ParseImuTable(ReadFile(data), data, StampUnit::kNanoseconds);
  if (!table.told.empty()) LogWarning(table.told);
  imu.samples = std::move(table.samples);
  return imu;
} catch (const Error& error) {
  LogWarning(std::string(error.what()) + "; the inertial readings are left out");
  return std::nullopt;
}

}  // namespace alidade
