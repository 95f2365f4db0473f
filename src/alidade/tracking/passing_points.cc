#include "alidade/tracking/passing_points.h"

#include <algorithm>

#include "alidade/features/guided_search.h"

namespace alidade {
namespace {

// Frames. The map is adjusted meanwhile, and the object may move slightly.
constexpr int kOldest = 60;

bool IsDoubtful(const PlacedFrame& placed, int keypoint) {
  const float p = placed.frame->Static(keypoint);
  return p >= Frame::kUsable && p < Frame::kMappable && !placed.matches[keypoint].valid();
}

}  // namespace

std::vector<PassingMatch> PassingPoints::Find(const PlacedFrame& placed, float radius,
                                              int max_distance) const {
  std::vector<PassingMatch> found;
  std::vector<uint8_t> taken(placed.frame->keypoints.size(), 0);
  for (size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    const Eigen::Vector3d p = placed.T_camera_world * point.p_world;
    if (p.z() <= 0.01) continue;
    const Eigen::Vector2d pixel = camera_.Project(p);
    Sought sought;
    sought.descriptor = &point.descriptor;
    sought.x = static_cast<float>(pixel.x());
    sought.y = static_cast<float>(pixel.y());
    sought.right_x = static_cast<float>(pixel.x() - camera_.bf() / p.z());
    sought.radius = radius * static_cast<float>(ScaleOfLevel(point.level));
    sought.min_level = point.level - 1;
    sought.max_level = point.level + 1;
    const Sighting seen =
        FindNear(*placed.frame, sought, [&](int k) { return !taken[k] && IsDoubtful(placed, k); });
    if (seen.keypoint < 0 || seen.distance > max_distance) continue;
    taken[seen.keypoint] = 1;
    found.push_back({seen.keypoint, static_cast<int>(i), point.p_world});
  }
  return found;
}

void PassingPoints::Update(const PlacedFrame& placed, uint64_t world) {
  std::vector<Point> kept;
  std::vector<uint8_t> known(placed.frame->keypoints.size(), 0);
  if (world == world_) {
    for (const PassingMatch& match : placed.passing) {
      if (match.point >= static_cast<int>(points_.size())) continue;
      Point point = points_[match.point];
      if (++point.age > kOldest) continue;
      point.level = placed.frame->keypoints[match.keypoint].level;
      point.descriptor = placed.frame->descriptors[match.keypoint];
      kept.push_back(point);
      known[match.keypoint] = 1;
    }
  }
  world_ = world;
  const Se3 T_world_camera = placed.T_camera_world.Inverse();
  for (int k = 0; k < static_cast<int>(placed.frame->keypoints.size()); ++k) {
    const Keypoint& keypoint = placed.frame->keypoints[k];
    if (known[k] || !keypoint.has_depth() || !IsDoubtful(placed, k)) continue;
    kept.push_back({T_world_camera * (keypoint.depth * camera_.Unproject(keypoint.pixel())),
                    placed.frame->descriptors[k], keypoint.level, 0});
  }
  points_ = std::move(kept);
}

}  // namespace alidade
