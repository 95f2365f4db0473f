// Conversions between gray and color, as cv::cvtColor does them. That function refers to all color
// spaces, which are a twelfth of the module for browsers.
#pragma once

#include <opencv2/core.hpp>

namespace alidade {

// CV_8UC1 of an image with 3 or 4 channels of 8 bits (BT.601). `red_first`: red, green, blue(,
// alpha) instead of blue, green, red(, alpha).
cv::Mat GrayOf(const cv::Mat& color, bool red_first = false);

// CV_8UC3, blue first. `image`: 1, 3 or 4 channels of 8 bits; `red_first` as above.
cv::Mat BgrOf(const cv::Mat& image, bool red_first = false);

}  // namespace alidade
