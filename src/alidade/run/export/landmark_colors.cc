#include "alidade/run/export/landmark_colors.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

// Bilinear; red green blue. At the border the nearest pixel.
Eigen::Vector3d ColorAt(const cv::Mat& image, double x, double y) {
  x = std::clamp(x, 0.0, image.cols - 1.0);
  y = std::clamp(y, 0.0, image.rows - 1.0);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, image.cols - 1), bottom = std::min(top + 1, image.rows - 1);
  const auto at = [&](int u, int v) -> Eigen::Vector3d {
    if (image.channels() == 1) return Eigen::Vector3d::Constant(image.at<uint8_t>(v, u));
    const auto& bgr = image.at<cv::Vec3b>(v, u);
    return {double(bgr[2]), double(bgr[1]), double(bgr[0])};
  };
  const double u = x - left, v = y - top;
  return (1 - v) * ((1 - u) * at(left, top) + u * at(right, top)) +
         v * ((1 - u) * at(left, bottom) + u * at(right, bottom));
}

}  // namespace

LandmarkColors::LandmarkColors(const SavedMap& saved, const MapPart& part, cv::Size recorded)
    : scale_x_(static_cast<double>(recorded.width) / saved.camera.width),
      scale_y_(static_cast<double>(recorded.height) / saved.camera.height),
      used_(part.landmarks.begin(), part.landmarks.end()) {}

void LandmarkColors::Add(const cv::Mat& image, const KeyFrame& keyframe) {
  for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    const LandmarkId id = keyframe.landmarks[i];
    if (!id.valid() || used_.count(id) == 0) continue;
    const Keypoint& keypoint = keyframe.frame->keypoints[i];
    Sum& sum = sums_[id];
    sum.color += ColorAt(image, (keypoint.raw_x + 0.5) * scale_x_ - 0.5,
                         (keypoint.raw_y + 0.5) * scale_y_ - 0.5);
    ++sum.count;
  }
}

std::optional<std::array<uint8_t, 3>> LandmarkColors::Of(LandmarkId id) const {
  const auto found = sums_.find(id);
  if (found == sums_.end()) return std::nullopt;
  std::array<uint8_t, 3> color{};
  for (size_t channel = 0; channel < 3; ++channel) {
    const double mean =
        found->second.color[static_cast<Eigen::Index>(channel)] / found->second.count;
    color[channel] = static_cast<uint8_t>(std::lround(mean));
  }
  return color;
}

}  // namespace alidade
