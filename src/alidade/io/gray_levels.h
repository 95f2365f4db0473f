// 16-bit gray images of 10, 12 or 14 bits, and thermal ones, as 8-bit images.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

namespace alidade {

// Maps the gray levels of a recording to 8 bits by one straight line for all images. The line is
// widened during the first second, then kept: black and white are the .5th and 99.5th percentile of
// the images so far, with a tenth of their distance added on either side. Images that use at least
// a quarter of the 65,536 levels keep all of them. One thread.
class GrayLevels {
 public:
  // `image`: CV_8UC1, returned as it is, or CV_16UC1. `time`: seconds.
  cv::Mat To8Bit(const cv::Mat& image, double time);

  // Gray levels that become 0 and 255; nullopt: no 16-bit image came so far.
  struct Range {
    double black, white;
  };
  std::optional<Range> range() const { return range_; }
  // `color` (CV_8UC3 or CV_16UC3) with the brightness of the gray images so far, CV_8UC3.
  cv::Mat ColorTo8Bit(const cv::Mat& color) const;

 private:
  void Learn(const cv::Mat& image);

  std::optional<double> first_;  // time of the first 16-bit image, seconds
  std::optional<Range> range_;
  std::optional<Range> percentiles_;  // smallest and largest so far
};

}  // namespace alidade
