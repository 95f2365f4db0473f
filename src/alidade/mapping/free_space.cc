#include "alidade/mapping/free_space.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

constexpr size_t kMost = 12;   // keyframes that are compared; more are thinned out evenly
constexpr int kVisited = 200;  // keyframes that are looked through
constexpr double kPixels = 4;  // of disparity
constexpr float kNeighbors =
    48;  // pixels, of the cells of keypoints that may be on the same surface

enum class Verdict : uint8_t { kUnknown, kOccupied, kFree };

// The smallest depth in the 3 × 3 cells around a pixel, meters; 0 if one of them is unknown.
float NearestAround(const cv::Mat& nearest, const Eigen::Vector2d& raw) {
  const int column = static_cast<int>(raw.x()) / Frame::kDepthCell;
  const int row = static_cast<int>(raw.y()) / Frame::kDepthCell;
  if (column >= nearest.cols || row >= nearest.rows) return 0;
  float smallest = nearest.at<float>(row, column);
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, nearest.rows - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, nearest.cols - 1); ++x)
      smallest = std::min(smallest, nearest.at<float>(y, x));
  }
  return smallest;
}

std::vector<const KeyFrame*> KeyFramesBefore(const MapState& map, const KeyFrame& present,
                                             double seconds) {
  std::vector<const KeyFrame*> all;
  int visited = 0;
  map.keyframes.ForEachFromLast([&](const KeyFrame& keyframe) {
    if (++visited > kVisited) return false;
    if (keyframe.map != present.map || keyframe.id == present.id) return true;
    const double before = present.frame->time - keyframe.frame->time;
    if (!(before > 0)) return false;  // of another recording
    if (!keyframe.frame->nearest.empty()) all.push_back(&keyframe);
    return before < seconds;
  });
  std::vector<const KeyFrame*> some;
  const size_t step = std::max<size_t>(1, (all.size() + kMost - 1) / kMost);
  for (size_t i = 0; i < all.size(); i += step) some.push_back(all[all.size() - 1 - i]);
  return some;
}

Verdict Look(const std::vector<const KeyFrame*>& before, const Camera& camera,
             const Eigen::Vector3d& p_world) {
  Verdict verdict = Verdict::kUnknown;
  for (const KeyFrame* keyframe : before) {
    const Eigen::Vector3d p = keyframe->T_camera_world * p_world;
    if (!(p.z() > 0)) continue;
    const Eigen::Vector2d raw = camera.Distort(camera.Project(p));
    if (!(raw.x() >= 0 && raw.y() >= 0 && raw.x() < camera.width && raw.y() < camera.height))
      continue;
    const double behind = NearestAround(keyframe->frame->nearest, raw);
    if (!(behind > 0)) continue;
    const double nearer = camera.bf() * (1 / p.z() - 1 / behind);
    if (nearer > kPixels) return Verdict::kFree;
    if (nearer > -kPixels) verdict = Verdict::kOccupied;  // else something else is in front
  }
  return verdict;
}

}  // namespace

std::vector<uint8_t> HasAppeared(const MapState& map, const Camera& camera, KeyFrameId id,
                                 double seconds) {
  const KeyFrame& present = *map.keyframes.At(id.value);
  const Frame& frame = *present.frame;
  std::vector<uint8_t> appeared(frame.keypoints.size(), 0);
  if (frame.nearest.empty()) return appeared;
  const std::vector<const KeyFrame*> before = KeyFramesBefore(map, present, seconds);
  const Se3 T_world_camera = present.T_camera_world.Inverse();
  std::vector<Verdict> verdicts(frame.keypoints.size(), Verdict::kUnknown);
  for (size_t i = 0; i < verdicts.size(); ++i) {
    const Keypoint& k = frame.keypoints[i];
    if (k.has_depth())
      verdicts[i] = Look(before, camera, T_world_camera * camera.Unproject(k.pixel(), k.depth));
  }
  if (std::find(verdicts.begin(), verdicts.end(), Verdict::kFree) == verdicts.end())
    return appeared;
  for (size_t i = 0; i < verdicts.size(); ++i) {
    const Keypoint& k = frame.keypoints[i];
    if (!k.has_depth()) continue;
    int free = 0, occupied = 0;
    frame.grid.VisitNear(k.x, k.y, kNeighbors, [&](int n) {
      const Keypoint& other = frame.keypoints[n];
      if (!other.has_depth() || verdicts[n] == Verdict::kUnknown) return;
      if (std::abs(camera.bf() / k.depth - camera.bf() / other.depth) > kPixels) return;
      ++(verdicts[n] == Verdict::kFree ? free : occupied);
    });
    appeared[i] = free > occupied;
  }
  return appeared;
}

}  // namespace alidade
