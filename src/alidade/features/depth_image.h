// A registered depth image, read in metres whatever it is stored in.
#pragma once

#include <limits>
#include <opencv2/core.hpp>

#include "alidade/geometry/camera.h"

namespace alidade {

class DepthImage {
 public:
  // `image`: CV_16U in camera.depth_factor units or CV_32F metres, may be empty; the caller's, who
  // keeps it as long as this.
  DepthImage(const cv::Mat& image, const Camera& camera)
      : image_(image),
        integers_(image.type() == CV_16UC1),
        unit_(static_cast<float>(1 / camera.depth_factor)) {}

  cv::Size size() const { return image_.size(); }

  // Metres along z at a pixel; 0 where there is no reading, and outside the image.
  float At(int x, int y) const {
    if (x < 0 || y < 0 || x >= image_.cols || y >= image_.rows) return 0;
    const float z =
        integers_ ? static_cast<float>(image_.at<uint16_t>(y, x)) * unit_ : image_.at<float>(y, x);
    return z > 0 && z <= std::numeric_limits<float>::max() ? z : 0;
  }

 private:
  const cv::Mat& image_;
  bool integers_;
  float unit_;  // metres
};

}  // namespace alidade
