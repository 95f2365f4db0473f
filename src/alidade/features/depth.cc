// Depth of keypoints from a registered depth image.
#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/features/extractor.h"

namespace alidade {
namespace {

constexpr float kEdgeSpread =
    0.05f;  // share of the depth: within a surface seen at a slant it stays below

// Metres, or 0 where there is no reading.
template <typename Value>
float ReadDepth(const cv::Mat& depth, int x, int y, float factor) {
  const float value = static_cast<float>(depth.at<Value>(y, x)) * factor;
  return std::isfinite(value) && value > 0 ? value : 0;
}

template <typename Value>
float DepthAt(const cv::Mat& depth, int x, int y, float factor) {
  if (x < 0 || y < 0 || x >= depth.cols || y >= depth.rows) return Keypoint::kNoDepth;
  const float centre = ReadDepth<Value>(depth, x, y, factor);
  if (centre == 0) return Keypoint::kNoDepth;
  float nearest = centre, farthest = centre;
  for (int v = std::max(0, y - 1); v <= std::min(depth.rows - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(depth.cols - 1, x + 1); ++u) {
      const float d = ReadDepth<Value>(depth, u, v, factor);
      if (d == 0) continue;
      nearest = std::min(nearest, d);
      farthest = std::max(farthest, d);
    }
  }
  return farthest - nearest > kEdgeSpread * centre ? Keypoint::kNoDepth : centre;
}

}  // namespace

void AttachDepth(const cv::Mat& depth, const Camera& camera, Frame& frame) {
  const bool integers = depth.type() == CV_16UC1;
  if (!integers && depth.type() != CV_32FC1) {
    ThrowInput("depth image: must have one channel of 16 bit integers or 32 bit floats");
  }
  if (depth.size() != frame.image.size()) {
    ThrowInput("depth image: its size differs from the colour image's");
  }
  if (integers && !(camera.depth_factor > 0)) {
    ThrowInput("depth image: the camera's depth_factor must be positive");
  }
  const float factor = integers ? static_cast<float>(1 / camera.depth_factor) : 1.f;
  const float bf = static_cast<float>(camera.bf());
  for (Keypoint& k : frame.keypoints) {
    const int x = static_cast<int>(std::lround(k.raw_x)),
              y = static_cast<int>(std::lround(k.raw_y));
    k.depth =
        integers ? DepthAt<uint16_t>(depth, x, y, factor) : DepthAt<float>(depth, x, y, factor);
    k.right_x = k.has_depth() ? k.x - bf / k.depth : Keypoint::kNoDepth;
  }
}

}  // namespace alidade
