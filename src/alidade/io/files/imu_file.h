// Files with inertial readings, and what is known of their sensor.
#pragma once

#include <optional>
#include <string>

#include "alidade/io/files/yaml.h"
#include "alidade/io/wrappers.h"

namespace alidade {

// The readings of a source, cleaned by ImuStream. `name` begins the warnings of what was odd. Sets
// model.rate if it is unknown. nullopt, with a warning: they must not be used.
std::optional<ImuRecording> CleanImu(ImuRecording imu, const std::string& name);

// A table of readings (ParseImuTable()); the sensor is unknown. `told`: units that were recognized
// by size, a sentence. Throws Error (input).
std::optional<ImuRecording> ReadImuFile(const std::string& path, std::string* told);

// The same for the table beside a recording: imu.csv or, of our phone page, motion.csv in the
// folder; walk.mp4.imu.csv beside the file walk.mp4. Empty: there is none.
std::string ImuFileBeside(const std::string& recording);

// EuRoC's imu0: data.csv and sensor.yaml (noise densities and rate, T_BS). `T_body_camera`: pose of
// the camera in the body frame; nullopt: not known. The model is of the camera as mounted. nullopt,
// with a warning: `folder` has no readings that can be used.
std::optional<ImuRecording> ReadEurocImu(const std::string& folder,
                                         const std::optional<Se3>& T_body_camera);

// The block `imu` of camera.yaml: T_camera_imu (of the left camera as mounted), rate, gyro_noise,
// accel_noise, gyro_walk, accel_walk, time_offset. What is missing is unknown. Throws Error (input)
// with file:line.
ImuModel ImuModelOf(const YamlFile& file, const YAML::Node& imu);
// The same of a camera file; nullopt: it has none, or is of another tool.
std::optional<ImuModel> ReadImuModel(const std::string& camera_file);

}  // namespace alidade
