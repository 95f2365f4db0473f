// Converts ROS's CameraInfo, from a message or a file, to a calibration.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/calibration.h"

namespace alidade {

// The fields of sensor_msgs/CameraInfo, with the message's names.
struct CameraInfo {
  uint32_t width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{}, R{};  // row-major
  std::array<double, 12> P{};
  uint32_t binning_x = 0, binning_y = 0;
  uint32_t roi_x = 0, roi_y = 0, roi_height = 0, roi_width = 0;
};

// The camera of one image topic: for rectified images from P, without distortion; otherwise from K
// and D, with binning and region of interest applied. nullopt: the camera was never calibrated (K
// is 0, REP 104). Throws Error (input), with advice, for unsupported lenses. Supported models:
// plumb_bob; equidistant (fisheye); rational_polynomial if Alidade's models approximate it (see
// calibrations/lens_fit.h). `told`, if given, receives what was approximated.
std::optional<RawCamera> CameraOfInfo(const CameraInfo& info, bool rectified,
                                      std::string* told = nullptr);

// Adds the right camera and its pose to the left camera's calibration. By REP 104 the baseline is
// -P[3] / P[0] of the right camera, and R rotates each camera into the common frame of the pair.
// Returns false when no baseline is stated.
bool AddRightCamera(const CameraInfo& left, const CameraInfo& right, bool rectified,
                    Calibration& calibration);

}  // namespace alidade
