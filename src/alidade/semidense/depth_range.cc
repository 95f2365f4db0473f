#include "alidade/semidense/depth_range.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

constexpr int kEnough = 4;        // landmarks nearby that say something of a place
constexpr float kMargin = 0.12f;  // share by which things may be nearer or farther than landmarks

}  // namespace

DepthRange::DepthRange(const MapSnapshot& map, const KeyFrame& keyframe, const Camera& camera) {
  columns_ = (camera.width + kCell - 1) / kCell;
  const int rows = (camera.height + kCell - 1) / kCell;
  cells_.resize(columns_ * rows);
  std::vector<std::vector<float>> near(cells_.size());
  double sum = 0, squares = 0;
  int count = 0;
  for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    const Landmark* landmark =
        keyframe.landmarks[i].valid() ? map.Find(keyframe.landmarks[i]) : nullptr;
    if (!landmark) continue;
    const double z = (keyframe.T_camera_world * landmark->p_world).z();
    if (z <= 0) continue;
    const auto inverse = static_cast<float>(1 / z);
    sum += inverse;
    squares += inverse * inverse;
    ++count;
    const Keypoint& keypoint = keyframe.frame->keypoints[i];
    const int column = std::clamp(static_cast<int>(keypoint.x) / kCell, 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(keypoint.y) / kCell, 0, rows - 1);
    for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c) {
        near[r * columns_ + c].push_back(inverse);
      }
    }
  }
  if (count < kEnough) return;
  const double mean = sum / count;
  const double sigma = std::sqrt(std::max(0.0, squares / count - mean * mean));
  all_.min = static_cast<float>(std::max(0.0, mean - 2 * sigma) * (1 - kMargin));
  all_.max = static_cast<float>((mean + 2 * sigma) * (1 + kMargin));
  for (size_t i = 0; i < cells_.size(); ++i) {
    cells_[i] = all_;
    if (static_cast<int>(near[i].size()) < kEnough) continue;
    const auto [least, most] = std::minmax_element(near[i].begin(), near[i].end());
    cells_[i] = {*least * (1 - kMargin), *most * (1 + kMargin)};
  }
}

}  // namespace alidade
