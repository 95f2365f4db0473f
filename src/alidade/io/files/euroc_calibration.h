// EuRoC's sensor.yaml of a camera.
#pragma once

#include <string>

#include "alidade/geometry/raw_camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

struct EurocCamera {
  RawCamera raw;
  Se3 T_body_camera;  // T_BS
  double fps = 20;    // rate_hz
};

// Throws Error with file:line. distortion_model: radial-tangential (4 or 5 coefficients) or
// equidistant (4).
EurocCamera ReadEurocCamera(const std::string& path);
EurocCamera ParseEurocCamera(const std::string& text, const std::string& name);

}  // namespace alidade
