// Camera files: our camera.yaml, and how a recording without one is dealt with.
#pragma once

#include <optional>
#include <string>

#include "alidade/base/api.h"
#include "alidade/io/calibration.h"

namespace ALIDADE_API alidade {

inline constexpr double kDefaultFovDegrees =
    66;  // along the longer side; most phones' main camera lies between 60 and 70

// camera.yaml: `model: pinhole|fisheye`, `width height fx fy cx cy`, `distortion: [k1 k2 p1 p2 k3]`
// (fisheye: [k1 k2 k3 k4]), `fps`, `readout` (rolling shutter: seconds from
// the top to the bottom row, or [left to right, top to bottom]), `depth_factor`, and for a stereo
// pair `baseline` (metres) or `right: {width …, T_left_right: 4x4}`. Throws Error with file:line
// for what is missing, unknown or impossible.
Calibration ReadCameraFile(const std::string& path);
// The same of a file's text; `name` is what it is called in errors.
Calibration ParseCameraFile(const std::string& text, const std::string& name);

// The same of a camera, as text that ReadCameraFile() reads back exactly; `comment`: lines for the
// begin, without their #.
std::string FormatCameraFile(const Camera& camera, const std::string& comment = {});

// A pinhole of that field of view, and nothing else known.
Calibration GuessedCalibration(int width, int height, double fov_degrees);

}  // namespace alidade
