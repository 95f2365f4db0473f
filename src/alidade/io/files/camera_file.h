// Camera files: Alidade's camera.yaml, and the assumed camera of a recording without one.
#pragma once

#include <optional>
#include <string>

#include "alidade/base/api.h"
#include "alidade/io/calibration.h"

namespace ALIDADE_API alidade {

// Degrees along the longer side. The main camera of most phones has 60 to 70.
inline constexpr double kDefaultFovDegrees = 66;

// camera.yaml: `model: pinhole|fisheye`, `width height fx fy cx cy`, `distortion: [k1 k2 p1 p2 k3]`
// (fisheye: [k1 k2 k3 k4]), `fps`, `readout` (rolling shutter, seconds from the top to the bottom
// row, or [left to right, top to bottom]), `depth_factor`, and for a stereo pair `baseline`
// (meters) or `right: {width …, T_left_right: 4x4}`. Throws Error (input) with file:line for a
// missing or invalid value; warns of unknown keys.
Calibration ReadCameraFile(const std::string& path);
// The same for a file's text; `name` appears in errors.
Calibration ParseCameraFile(const std::string& text, const std::string& name);

// Formats a camera as text that ReadCameraFile() reads back exactly. `comment`: lines for the
// beginning, without #.
std::string FormatCameraFile(const Camera& camera, const std::string& comment = {});

// A pinhole camera with this horizontal field of view, and no other calibration.
Calibration GuessedCalibration(int width, int height, double fov_degrees);

}  // namespace alidade
