#include "alidade/features/frame.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace alidade {
namespace {

// Pixels. Undistorted positions outside the image are resolved up to this distance only, so that
// one outlier cannot enlarge the grid.
constexpr float kMargin = 256;  // pixels

int CellOf(float v, int limit) {
  return std::clamp(static_cast<int>(std::floor(v / KeypointGrid::kCell)), 0, limit - 1);
}

}  // namespace

double ScaleOfLevel(int level) {
  static const std::array<double, 2 * kPyramidLevels> kScales = [] {
    std::array<double, 2 * kPyramidLevels> scales{};
    double scale = 1;
    for (double& s : scales) {
      s = scale;
      scale *= kPyramidScale;
    }
    return scales;
  }();
  return kScales[std::clamp(level, 0, static_cast<int>(kScales.size()) - 1)];
}

KeypointGrid::KeypointGrid(std::span<const Keypoint> keypoints, int width, int height) {
  if (width <= 0 || height <= 0) return;
  float right = static_cast<float>(width), bottom = static_cast<float>(height);
  for (const Keypoint& k : keypoints) {
    left_ = std::min(left_, k.x);
    top_ = std::min(top_, k.y);
    right = std::max(right, k.x);
    bottom = std::max(bottom, k.y);
  }
  left_ = std::max(left_, -kMargin);
  top_ = std::max(top_, -kMargin);
  right = std::min(right, static_cast<float>(width) + kMargin);
  bottom = std::min(bottom, static_cast<float>(height) + kMargin);
  columns_ = static_cast<int>((right - left_) / kCell) + 1;
  rows_ = static_cast<int>((bottom - top_) / kCell) + 1;

  // Counting sort: count per cell, start of each cell, then place every index.
  first_.assign(static_cast<size_t>(columns_) * rows_ + 1, 0);
  order_.resize(keypoints.size());
  std::vector<int> cells(keypoints.size());
  for (size_t i = 0; i < keypoints.size(); ++i) {
    cells[i] =
        CellOf(keypoints[i].y - top_, rows_) * columns_ + CellOf(keypoints[i].x - left_, columns_);
    ++first_[cells[i] + 1];
  }
  for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (size_t i = 0; i < keypoints.size(); ++i) order_[next[cells[i]]++] = static_cast<int>(i);
}

}  // namespace alidade
