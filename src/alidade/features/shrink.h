// Smaller copies of 8-bit images: the same bits as cv::resize's, in a fraction of its time.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Every pixel is the mean of the area that it covers, partly covered pixels in proportion: as
// cv::resize with INTER_AREA. `image`: 1 to 4 channels of 8 bits, not empty; `size`: not empty; of
// images that get larger along an axis, what cv::resize does with them.
cv::Mat ShrinkArea(const cv::Mat& image, cv::Size size);

// Linear interpolation between the pixels around each center: as cv::resize with INTER_LINEAR. Sums
// less than ShrinkArea(); meant for factors below 2. `image` and `size` as there. The result is
// written to `memory` if that is of its size and type.
cv::Mat ShrinkLinear(const cv::Mat& image, cv::Size size, cv::Mat memory = {});

}  // namespace alidade
