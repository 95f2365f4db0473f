// An image of a bare wall.
#pragma once

#include <opencv2/core.hpp>

#include "support/texture.h"

namespace alidade {

// Grey, lighter in the middle, with a camera's noise.
inline cv::Mat BareWall() {
  cv::Mat wall(480, 640, CV_8UC1);
  for (int y = 0; y < wall.rows; ++y) {
    for (int x = 0; x < wall.cols; ++x)
      wall.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(
          190 - 60 * (cv::Point2d(x / 640.0 - 0.5, y / 480.0 - 0.5).dot({x / 640.0 - 0.5, 0}) +
                      (y / 480.0 - 0.5) * (y / 480.0 - 0.5)));
  }
  AddNoise(wall, 2, 3);
  return wall;
}

}  // namespace alidade
