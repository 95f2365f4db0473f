#include "alidade/features/pyramid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/base/part_times.h"
#include "alidade/features/frame.h"
#include "alidade/features/shrink.h"

namespace alidade {

std::vector<cv::Size> PyramidSizes(cv::Size image) {
  std::vector<cv::Size> sizes;
  for (int level = 0; level < kPyramidLevels; ++level) {
    const double scale = ScaleOfLevel(level);
    sizes.emplace_back(std::max(1, static_cast<int>(std::lround(image.width / scale))),
                       std::max(1, static_cast<int>(std::lround(image.height / scale))));
  }
  return sizes;
}

std::vector<cv::Mat> BuildPyramid(const cv::Mat& image, std::vector<cv::Mat> memory) {
  const PartTimer timer(FramePart::kPyramid);
  const std::vector<cv::Size> sizes = PyramidSizes(image.size());
  std::vector<cv::Mat> pyramid = std::move(memory);
  pyramid.resize(kPyramidLevels);
  pyramid[0] = image;
  for (int level = 1; level < kPyramidLevels; ++level) {
    pyramid[level] = ShrinkLinear(pyramid[level - 1], sizes[level], std::move(pyramid[level]));
  }
  return pyramid;
}

}  // namespace alidade
