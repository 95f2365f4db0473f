// Depth of keypoints from a registered depth image.
#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/base/error.h"
#include "alidade/features/depth_image.h"
#include "alidade/features/extractor.h"

namespace alidade {
namespace {

// Share of the depth; a slanted surface stays below it.
constexpr float kEdgeSpread = 0.05f;

// Pixels, larger than any image width. A nearer reading is invalid, and its right_x would be
// outside the range that a map file accepts.
constexpr float kMostDisparity = 1e6f;

float DepthAt(const DepthImage& depth, int x, int y) {
  const float centre = depth.At(x, y);
  if (centre == 0) return Keypoint::kNoDepth;
  float nearest = centre, farthest = centre;
  for (int v = y - 1; v <= y + 1; ++v) {
    for (int u = x - 1; u <= x + 1; ++u) {
      const float d = depth.At(u, v);
      if (d == 0) continue;
      nearest = std::min(nearest, d);
      farthest = std::max(farthest, d);
    }
  }
  return farthest - nearest > kEdgeSpread * centre ? Keypoint::kNoDepth : centre;
}

// Frame::nearest. Every second pixel in both directions is read.
cv::Mat NearestOfCells(const DepthImage& depth) {
  constexpr int kCell = Frame::kDepthCell, kStep = 2;
  const cv::Size size = depth.size();
  cv::Mat nearest(size.height / kCell, size.width / kCell, CV_32F);
  for (int row = 0; row < nearest.rows; ++row) {
    for (int column = 0; column < nearest.cols; ++column) {
      int known = 0;
      float smallest = std::numeric_limits<float>::max();
      for (int y = row * kCell; y < (row + 1) * kCell; y += kStep) {
        for (int x = column * kCell; x < (column + 1) * kCell; x += kStep) {
          const float z = depth.At(x, y);
          if (z == 0) continue;
          ++known;
          smallest = std::min(smallest, z);
        }
      }
      const bool enough = 8 * known >= (kCell / kStep) * (kCell / kStep);
      nearest.at<float>(row, column) = enough ? smallest : 0;
    }
  }
  return nearest;
}

}  // namespace

void ReadDepths(const cv::Mat& depth, const Camera& camera, Frame& frame, double range) {
  const bool integers = depth.type() == CV_16UC1;
  if (!integers && depth.type() != CV_32FC1) {
    ThrowInput("depth image: must have one channel of 16-bit integers or 32-bit floats");
  }
  if (depth.cols != camera.width || depth.rows != camera.height) {
    ThrowInput("depth image: its size differs from that of the color image");
  }
  if (integers && !(camera.depth_factor > 0)) {
    ThrowInput("depth image: the camera's depth_factor must be positive");
  }
  const DepthImage image(depth, camera);
  const float bf = static_cast<float>(camera.bf());
  for (Keypoint& k : frame.keypoints) {
    k.depth = DepthAt(image, static_cast<int>(std::lround(k.raw_x)),
                      static_cast<int>(std::lround(k.raw_y)));
    if (k.depth > range || bf > kMostDisparity * k.depth) k.depth = Keypoint::kNoDepth;
    k.right_x = k.has_depth() ? k.x - bf / k.depth : Keypoint::kNoDepth;
  }
}

void AttachDepth(const cv::Mat& depth, const Camera& camera, Frame& frame, double range) {
  ReadDepths(depth, camera, frame, range);
  frame.nearest = NearestOfCells(DepthImage(depth, camera));
}

}  // namespace alidade
