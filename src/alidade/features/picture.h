// Images of a frame for semi-dense mapping, kept only if requested.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// All images are as taken by the (left) camera, not undistorted, and of the camera's size.
struct Picture {
  cv::Mat gray;        // CV_8U
  cv::Mat color = {};  // CV_8UC3, BGR; empty if not available
  // Sensor depth: CV_16U in units of 1 / camera.depth_factor, or CV_32F in meters; empty if there
  // is none.
  cv::Mat depth = {};
  cv::Mat mask = {};  // CV_8U, 255 = moving object; empty if there is none
};

}  // namespace alidade
