#include "alidade/semidense/landmark_agreement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "alidade/map/view.h"

namespace alidade {
namespace {

constexpr size_t kFewest = 10;  // landmarks required for a decision
constexpr int kNear = 2;        // pixels: a corner may lie beside the edge

}  // namespace

bool AgreesWithLandmarks(const MapSnapshot& map, const KeyFrame& keyframe,
                         std::span<const EdgePixel> edges, std::span<const Hypothesis> depth,
                         const Camera& camera, double max_difference) {
  const std::optional<double> median_depth = MedianDepth(map, keyframe);
  if (!median_depth) return false;
  cv::Mat1f inverse(camera.height, camera.width, 0.f);
  for (size_t i = 0; i < edges.size(); ++i) {
    if (depth[i].known()) inverse(edges[i].y, edges[i].x) = depth[i].inverse_depth;
  }
  std::vector<double> differences;
  for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    const LandmarkId id = keyframe.landmarks[i];
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (!landmark) continue;
    const double z = (keyframe.T_camera_world * landmark->p_world).z();
    if (z <= 0) continue;
    const Keypoint& keypoint = keyframe.frame->keypoints[i];
    const int x = static_cast<int>(std::lround(keypoint.x));
    const int y = static_cast<int>(std::lround(keypoint.y));
    double least = -1;
    for (int v = std::max(0, y - kNear); v <= std::min(camera.height - 1, y + kNear); ++v) {
      for (int u = std::max(0, x - kNear); u <= std::min(camera.width - 1, x + kNear); ++u) {
        if (inverse(v, u) <= 0) continue;
        const double difference = std::abs(inverse(v, u) - 1 / z);
        if (least < 0 || difference < least) least = difference;
      }
    }
    if (least >= 0) differences.push_back(least / std::max(1 / z, 1 / *median_depth));
  }
  if (differences.size() < kFewest) return false;
  const auto upper = differences.begin() + static_cast<std::ptrdiff_t>(3 * differences.size() / 4);
  std::nth_element(differences.begin(), upper, differences.end());
  return *upper <= max_difference;
}

}  // namespace alidade
