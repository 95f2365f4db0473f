// The text of a calibration as YAML, whatever of YAML, JSON and OpenCV's XML it is.
#pragma once

#include <string>

#include "alidade/io/files/yaml.h"

namespace alidade {

// Throws Error (input) naming `name` when the text is binary or damaged. Of several messages
// printed by `ros2 topic echo` the first is taken. Poses of images (transforms.json) are left out.
YamlFile YamlOfCalibration(const std::string& text, const std::string& name);

}  // namespace alidade
