// Camera files: Alidade's camera.yaml, calibrations of other tools, and the assumed camera of a
// recording without one.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "alidade/base/api.h"
#include "alidade/io/calibration.h"

namespace ALIDADE_API alidade {

// Degrees along the longer side. The main camera of most phones has 60 to 70.
inline constexpr double kDefaultFovDegrees = 66;

// Calibration files may be long where they list images (transforms.json).
inline constexpr size_t kMostCalibrationBytes = size_t{1} << 24;

// Reads camera.yaml: `model: pinhole|fisheye`, `width height fx fy cx cy`, `distortion: [k1 k2 p1
// p2 k3]` (fisheye: [k1 k2 k3 k4]), `fps`, `readout` (rolling shutter, seconds from the top to the
// bottom row, or [left to right, top to bottom]), `depth_factor`, and for a stereo pair `baseline`
// (meters) or `right: {width …, T_left_right: 4x4}`; and the calibrations of other tools that
// calibrations/formats.h lists, recognized by their content. `path#NAME` chooses a camera of a file
// with several. Throws Error (input) with file:line for a missing or invalid value; warns of
// unknown keys. `images`: size of the recording's images, by which one of a camera's sizes is
// chosen (rs-enumerate-devices). The size stays 0 when the file of another tool does not state it.
Calibration ReadCameraFile(const std::string& path, cv::Size images = {});
// The same for a file's text; `name` appears in errors, `which` is the chosen camera.
Calibration ParseCameraFile(const std::string& text, const std::string& name,
                            const std::string& which = {}, cv::Size images = {});
// The file's path without `#NAME`.
std::string CameraFilePath(const std::string& given);

// Throws Error (input) when a distortion folds inside the image. `with_right`: also the right
// camera's.
void RefuseFolds(const Calibration& calibration, bool with_right);
// Throws Error (input) when the calibration does not state the size of the images, or a distortion
// folds inside them. `with_right`: the right camera is used.
void RequireSize(const Calibration& calibration, bool with_right = true);

// A camera as a calibration, for FormatCalibration().
Calibration CalibrationOf(const Camera& camera);
// Formats a camera as text that ReadCameraFile() reads back exactly. `comment`: lines for the
// beginning, without #.
std::string FormatCameraFile(const Camera& camera, const std::string& comment = {});

// A pinhole camera with this horizontal field of view, and no other calibration.
Calibration GuessedCalibration(int width, int height, double fov_degrees);

}  // namespace alidade
