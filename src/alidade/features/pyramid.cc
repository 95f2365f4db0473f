#include "alidade/features/pyramid.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/features/frame.h"

namespace alidade {

std::vector<cv::Mat> BuildPyramid(const cv::Mat& image) {
  std::vector<cv::Mat> pyramid(kPyramidLevels);
  pyramid[0] = image;
  for (int level = 1; level < kPyramidLevels; ++level) {
    const double scale = ScaleOfLevel(level);
    const cv::Size size(std::max(1, static_cast<int>(std::lround(image.cols / scale))),
                        std::max(1, static_cast<int>(std::lround(image.rows / scale))));
    cv::resize(pyramid[level - 1], pyramid[level], size, 0, 0, cv::INTER_LINEAR);
  }
  return pyramid;
}

}  // namespace alidade
