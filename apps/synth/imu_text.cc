#include "synth/imu_text.h"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace alidade {
namespace {

std::string Fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

// Angular rate, then specific force.
std::string Reading(const ImuSample& sample) {
  std::string text;
  for (const Eigen::Vector3d& v : {sample.angular_rate, sample.specific_force}) {
    for (const double value : v) text += "," + Fixed(value, 9);
  }
  return text + "\n";
}

}  // namespace

std::string ExactText(double value) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return text;
}

std::string JoinNumbers(const std::vector<double>& values, const char* between) {
  std::string text;
  for (size_t i = 0; i < values.size(); ++i) text += (i > 0 ? between : "") + ExactText(values[i]);
  return text;
}

std::string MatrixText(const Se3& T, int rows, const char* between) {
  std::vector<double> values;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) values.push_back(T.R(row, column));
    values.push_back(T.t[row]);
  }
  if (rows == 4) values.insert(values.end(), {0, 0, 0, 1});
  return JoinNumbers(values, between);
}

std::string FormatImuCsv(const std::vector<ImuSample>& samples) {
  std::string text = "# t [s],wx [rad/s],wy [rad/s],wz [rad/s],ax [m/s^2],ay [m/s^2],az [m/s^2]\n";
  for (const ImuSample& sample : samples) text += Fixed(sample.time, 9) + Reading(sample);
  return text;
}

std::string FormatEurocImu(const std::vector<ImuSample>& samples, long long start) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m "
      "s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (const ImuSample& sample : samples)
    text +=
        std::to_string(start * 1'000'000'000LL + std::llround(sample.time * 1e9)) + Reading(sample);
  return text;
}

std::string FormatMotionCsv(const std::vector<ImuSample>& samples) {
  std::string text =
      "# seconds, acceleration with gravity x y z m/s^2, turning about x y z deg/s (W3C "
      "DeviceMotion: the device's own axes)\n";
  for (const ImuSample& sample : samples) {
    text += Fixed(sample.time, 6);
    for (const double value : sample.specific_force) text += "," + Fixed(value, 5);
    for (const double value : sample.angular_rate)
      text += "," + Fixed(value * 180 / std::numbers::pi, 5);
    text += "\n";
  }
  return text;
}

std::string FormatImuBlock(const ImuModel& model) {
  std::string text = "imu:\n  rate: " + ExactText(model.rate) + "\n";
  if (model.rotation_known && model.translation_known)
    text += "  T_camera_imu: [" + MatrixText(model.T_camera_imu, 4, ", ") +
            "]\n  gyro_noise: " + ExactText(model.noise.gyro) +
            "\n  accel_noise: " + ExactText(model.noise.accel) +
            "\n  gyro_walk: " + ExactText(model.noise.gyro_walk) +
            "\n  accel_walk: " + ExactText(model.noise.accel_walk) + "\n";
  if (model.time_offset_known) text += "  time_offset: " + ExactText(model.time_offset) + "\n";
  return text;
}

std::string FormatEurocImuSensor(const ImuModel& model, const Se3& T_body_camera) {
  return "# inertial sensor, rendered\nsensor_type: imu\ncomment: rendered inertial "
         "sensor\nT_BS:\n  cols: 4\n  rows: 4\n  data: [" +
         MatrixText(T_body_camera * model.T_camera_imu, 4, ", ") +
         "]\nrate_hz: " + ExactText(model.rate) +
         "\ngyroscope_noise_density: " + ExactText(model.noise.gyro) +
         "\ngyroscope_random_walk: " + ExactText(model.noise.gyro_walk) +
         "\naccelerometer_noise_density: " + ExactText(model.noise.accel) +
         "\naccelerometer_random_walk: " + ExactText(model.noise.accel_walk) + "\n";
}

}  // namespace alidade
