// Masks that are stretched over an image.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/geometry/camera.h"

namespace alidade {

// Whether `mask` (CV_8U of any size; may be empty) is nonzero at a raw pixel of the camera's image.
inline bool Marks(const cv::Mat& mask, float x, float y, const Camera& camera) {
  const int column = static_cast<int>((x + 0.5f) * static_cast<float>(mask.cols) /
                                      static_cast<float>(camera.width));
  const int row = static_cast<int>((y + 0.5f) * static_cast<float>(mask.rows) /
                                   static_cast<float>(camera.height));
  return column >= 0 && row >= 0 && column < mask.cols && row < mask.rows &&
         mask.at<uint8_t>(row, column) != 0;
}

}  // namespace alidade
