#include "alidade/features/color.h"

#include <opencv2/imgproc/hal/hal.hpp>

namespace alidade {

cv::Mat GrayOf(const cv::Mat& color, bool red_first) {
  cv::Mat gray(color.size(), CV_8UC1);
  cv::hal::cvtBGRtoGray(color.data, color.step, gray.data, gray.step, color.cols, color.rows, CV_8U,
                        color.channels(), red_first);
  return gray;
}

cv::Mat BgrOf(const cv::Mat& image, bool red_first) {
  cv::Mat bgr(image.size(), CV_8UC3);
  if (image.channels() == 1)
    cv::hal::cvtGraytoBGR(image.data, image.step, bgr.data, bgr.step, image.cols, image.rows, CV_8U,
                          3);
  else
    cv::hal::cvtBGRtoBGR(image.data, image.step, bgr.data, bgr.step, image.cols, image.rows, CV_8U,
                         image.channels(), 3, red_first);
  return bgr;
}

}  // namespace alidade
