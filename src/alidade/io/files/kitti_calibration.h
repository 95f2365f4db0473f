// KITTI's calib.txt: the projections P0..P3 of the rectified cameras.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "alidade/io/calibration.h"

namespace alidade {

// Calibration of camera `left_number` (0 gray, 2 color), with images of `size`, and of the camera
// to its right if the file has one. Throws Error (input) with file:line.
Calibration ReadKittiCalibration(const std::string& path, int left_number, cv::Size size);
// The same for a file's text; `name` appears in errors.
Calibration ParseKittiCalibration(const std::string& text, const std::string& name, int left_number,
                                  cv::Size size);

}  // namespace alidade
