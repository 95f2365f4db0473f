#include "alidade/io/files/depth_size.h"

#include <algorithm>
#include <cstdint>

#include "alidade/base/error.h"

namespace alidade {
namespace {

template <typename T>
cv::Mat Blocks(const cv::Mat& depth, int times) {
  cv::Mat scaled(depth.rows * times, depth.cols * times, depth.type());
  for (int y = 0; y < scaled.rows; ++y) {
    const auto* from = depth.ptr<T>(y / times);
    auto* to = scaled.ptr<T>(y);
    for (int x = 0; x < depth.cols; ++x, to += times) std::fill(to, to + times, from[x]);
  }
  return scaled;
}

}  // namespace

std::string SizeText(cv::Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

bool IsWholeFraction(cv::Size small, cv::Size size) {
  const int times = size.width / std::max(1, small.width);
  return times >= 2 && small * times == size;
}

std::string DepthSizeTold(cv::Size depth, cv::Size size) {
  if (depth == size) return {};
  if (IsWholeFraction(depth, size))
    return "Depth images of " + SizeText(depth) + " are scaled up to " + SizeText(size);
  ThrowInput("depth images of " + SizeText(depth) + " do not fit images of " + SizeText(size) +
             ": depth has the same size, or a half, a third, … of it; use --sensor mono to leave "
             "it out");
}

cv::Mat ScaledUpDepth(const cv::Mat& depth, cv::Size size) {
  if (!IsWholeFraction(depth.size(), size)) return depth;
  const int times = size.width / depth.cols;
  return depth.elemSize() == sizeof(uint16_t) ? Blocks<uint16_t>(depth, times)
                                              : Blocks<uint32_t>(depth, times);
}

}  // namespace alidade
