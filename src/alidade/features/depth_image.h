// Read access in meters to a registered depth image of either storage type.
#pragma once

#include <limits>
#include <opencv2/core.hpp>

#include "alidade/geometry/camera.h"

namespace alidade {

class DepthImage {
 public:
  // `image`: CV_16U in units of 1 / camera.depth_factor, or CV_32F in meters; may be empty. It is
  // referenced, not copied, and must outlive this object.
  DepthImage(const cv::Mat& image, const Camera& camera)
      : image_(image),
        integers_(image.type() == CV_16UC1),
        unit_(static_cast<float>(1 / camera.depth_factor)) {}

  cv::Size size() const { return image_.size(); }

  // Depth along z at a pixel, meters; 0 if there is no reading or the pixel is outside the image.
  float At(int x, int y) const {
    if (x < 0 || y < 0 || x >= image_.cols || y >= image_.rows) return 0;
    const float z =
        integers_ ? static_cast<float>(image_.at<uint16_t>(y, x)) * unit_ : image_.at<float>(y, x);
    return z > 0 && z <= std::numeric_limits<float>::max() ? z : 0;
  }

 private:
  const cv::Mat& image_;
  bool integers_;
  float unit_;  // meters per integer unit
};

}  // namespace alidade
