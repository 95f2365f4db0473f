// EuRoC's sensor.yaml of one camera.
#pragma once

#include <optional>
#include <string>

#include "alidade/geometry/raw_camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/io/files/yaml.h"

namespace alidade {

struct EurocCamera {
  RawCamera raw;
  Se3 T_body_camera;          // T_BS, meters
  std::optional<double> fps;  // rate_hz, frames per second
};

// Throw Error (input) with file:line. Supported values of distortion_model: radial-tangential (4 or
// 5 coefficients) and equidistant (4 coefficients).
EurocCamera ReadEurocCamera(const std::string& path);
EurocCamera ParseEurocCamera(const std::string& text, const std::string& name);
// Without `need_pose`, a missing T_BS is the identity.
EurocCamera EurocCameraOf(const YamlFile& file, bool need_pose);

}  // namespace alidade
