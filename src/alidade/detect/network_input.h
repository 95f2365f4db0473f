// A picture as the array a network reads.
#pragma once

#include <opencv2/core.hpp>

namespace alidade {

struct InputConvention {
  bool red_first = true;     // red green blue; false: blue green red
  float scale = 1.0f / 255;  // of values 0…255; 1 when the network wants them as they are
};

// 1 × 3 × height × width floats from a CV_8UC3 picture (blue green red), plane after plane.
cv::Mat ToNetworkInput(const cv::Mat& picture, const InputConvention& convention);

}  // namespace alidade
