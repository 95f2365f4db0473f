// Inertial readings and their sensor as text, for rendered recordings (docs/reference/sources.md).
#pragma once

#include <string>
#include <vector>

#include "alidade/inertial/imu.h"

namespace alidade {

// What a recording tells of its inertial sensor.
struct WrittenImu {
  ImuModel model;
  std::vector<ImuSample> samples;
};

// imu.csv: seconds, rad/s, m/s².
std::string FormatImuCsv(const std::vector<ImuSample>& samples);
// EuRoC's data.csv; `start`: whole seconds that are added to the times.
std::string FormatEurocImu(const std::vector<ImuSample>& samples, long long start);
// motion.csv as the page for phones records it.
std::string FormatMotionCsv(const std::vector<ImuSample>& samples);

// The block `imu:` of camera.yaml; keys of what is not known are left out.
std::string FormatImuBlock(const ImuModel& model);
// EuRoC's sensor.yaml of a sensor that is known.
std::string FormatEurocImuSensor(const ImuModel& model, const Se3& T_body_camera);

// Shared with the cameras' files: all digits of a number, a list of them, three or four rows of
// [R t].
std::string ExactText(double value);
std::string JoinNumbers(const std::vector<double>& values, const char* between);
std::string MatrixText(const Se3& T, int rows, const char* between);

}  // namespace alidade
