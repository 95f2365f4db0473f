// Writes calibrations in the formats of other tools.
#pragma once

#include <optional>
#include <string>

#include "alidade/inertial/imu.h"
#include "alidade/io/calibration.h"

namespace alidade {

enum class CalibrationStyle { kAlidade, kKalibr, kRos, kOpenCv, kColmap };

// "alidade", "kalibr", "ros", "opencv", "colmap".
const char* NameOf(CalibrationStyle style);
std::optional<CalibrationStyle> CalibrationStyleNamed(const std::string& name);
// The file's usual name: "camera.yaml", "camchain.yaml", "camera_info.yaml", "opencv.yaml",
// "cameras.txt".
const char* UsualFileName(CalibrationStyle style);

struct WrittenCalibration {
  std::string text;
  // Sentences, one a line: what was approximated or is not in the text; empty: nothing.
  std::string told;
};

// `comment`: lines for the beginning, without #. A pair is written where the format has one
// (Alidade, Kalibr, OpenCV), otherwise its left camera. Throws Error (usage) when the format cannot
// express the lens. `imu`: what is known of an inertial sensor, for Alidade and Kalibr (which needs
// its rotation); others have no place for it.
WrittenCalibration FormatCalibration(const Calibration& calibration, CalibrationStyle style,
                                     const std::string& comment = {},
                                     const std::optional<ImuModel>& imu = {});

// `text` without the lines that precede the comment: OpenCV's %YAML:1.0 and ---.
std::string CommentOfCalibration(const std::string& text);

}  // namespace alidade
