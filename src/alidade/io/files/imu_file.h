// Files with inertial readings, and the description of their sensor.
#pragma once

#include <optional>
#include <string>

#include "alidade/io/wrappers.h"

namespace alidade {

// EuRoC's imu0: data.csv and sensor.yaml (noise densities and rate, T_BS). `T_body_camera`: pose of
// the camera in the body frame; nullopt: not known. The model is of the camera as mounted. nullopt,
// with a warning: `folder` has no readings that can be used.
std::optional<ImuRecording> ReadEurocImu(const std::string& folder,
                                         const std::optional<Se3>& T_body_camera);

}  // namespace alidade
