// What sensor_msgs/CameraInfo says of cameras, as a calibration.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "alidade/io/calibration.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

// The picture's own camera: with `rectified` as P has it, without distortion; else as K and D have
// it, binning and region of interest applied. Nothing when the camera was never calibrated (K is 0,
// by REP 104). Throws Error (input), saying what to do, for lenses that cannot be worked with.
// Models: plumb_bob; equidistant (fisheye); rational_polynomial where five coefficients come within
// half a pixel of its eight.
std::optional<RawCamera> CameraOfInfo(const RosCameraInfo& info, bool rectified);

// A second camera's: adds it, and where it is, to the left camera's calibration. By REP 104 the
// baseline is -P[3] / P[0] of the right camera; R turns each camera into the pair's common frame.
// False when there is no baseline to be had.
bool AddRightCamera(const RosCameraInfo& left, const RosCameraInfo& right, bool rectified,
                    Calibration& calibration);

}  // namespace alidade
