// KITTI's calib.txt: the projections P0..P3 of the rectified cameras.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "alidade/io/calibration.h"

namespace alidade {

// Of the camera `left_number` (0 grey, 2 colour), whose images are of `size`, with the one to its
// right where there is one. Throws Error (input) with file:line.
Calibration ReadKittiCalibration(const std::string& path, int left_number, cv::Size size);
// The same of a file's text; `name` is what it is called in errors.
Calibration ParseKittiCalibration(const std::string& text, const std::string& name, int left_number,
                                  cv::Size size);

}  // namespace alidade
