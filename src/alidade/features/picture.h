// What dense work needs of an image, kept beside the keypoints when it is asked for.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// All as the (left) camera took them, lens distortion and all, of the camera's size.
struct Picture {
  cv::Mat gray;        // CV_8U
  cv::Mat color = {};  // CV_8UC3, blue green red; empty: none
  cv::Mat depth =
      {};  // from a sensor: CV_16U in camera.depth_factor units or CV_32F metres; or empty
  cv::Mat mask = {};  // CV_8U, 255 = moves by itself; empty: nothing does
};

}  // namespace alidade
