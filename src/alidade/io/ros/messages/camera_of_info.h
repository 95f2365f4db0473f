// Converts sensor_msgs/CameraInfo to a calibration.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "alidade/io/calibration.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

// The camera of one image topic: for rectified images from P, without distortion; otherwise from K
// and D, with binning and region of interest applied. nullopt: the camera was never calibrated (K
// is 0, REP 104). Throws Error (input), with advice, for unsupported lenses. Supported models:
// plumb_bob; equidistant (fisheye); rational_polynomial if five Brown coefficients approximate it
// within 0.5 pixels.
std::optional<RawCamera> CameraOfInfo(const RosCameraInfo& info, bool rectified);

// Adds the right camera and its pose to the left camera's calibration. By REP 104 the baseline is
// -P[3] / P[0] of the right camera, and R rotates each camera into the common frame of the pair.
// Returns false when no baseline is stated.
bool AddRightCamera(const RosCameraInfo& left, const RosCameraInfo& right, bool rectified,
                    Calibration& calibration);

}  // namespace alidade
