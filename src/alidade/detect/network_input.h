// Converts an image to a network's input array.
#pragma once

#include <opencv2/core.hpp>

namespace alidade {

struct InputConvention {
  bool red_first = true;     // red green blue; false: blue green red
  float scale = 1.0f / 255;  // factor for values 0…255; 1 when the network normalizes its input
};

// Returns 1 × 3 × height × width floats, plane by plane, from a CV_8UC3 image (blue green red).
cv::Mat ToNetworkInput(const cv::Mat& picture, const InputConvention& convention);

}  // namespace alidade
