#include "alidade/mapping/turn.h"

#include <cstdlib>

#include "alidade/features/matching.h"
#include "alidade/map/view.h"

namespace alidade {
namespace {

struct Lookalike {
  int keypoint = -1;   // keypoint index; -1: none
  int distance = 256;  // Hamming distance, bits
};

// The keypoint of keyframe `in` without a landmark that matches `descriptor` within
// settings.turn_radius of `pixel`, clearly better than any other there.
Lookalike LookFor(const Keypoint& key, const Descriptor& descriptor, const Eigen::Vector2d& pixel,
                  const KeyFrame& in, const MapperSettings& settings) {
  Lookalike best;
  int second = 256;
  const double most = settings.turn_radius * ScaleOfLevel(key.level + 1);
  const auto visit = [&](int j) {
    const Keypoint& other = in.frame->keypoints[j];
    const double reach = settings.turn_radius * ScaleOfLevel(other.level);
    if (in.landmarks[j].valid() || std::abs(other.level - key.level) > 1 ||
        (other.pixel() - pixel).squaredNorm() > reach * reach)
      return;
    const int distance = HammingDistance(descriptor, in.frame->descriptors[j]);
    if (distance < best.distance) {
      second = best.distance;
      best = {j, distance};
    } else if (distance < second) {
      second = distance;
    }
  };
  in.frame->grid.VisitNear(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                           static_cast<float>(most), visit);
  const bool clear = best.distance <= settings.triangulate_distance &&
                     best.distance <= settings.triangulate_ratio * second;
  return clear ? best : Lookalike{};
}

}  // namespace

std::vector<NewLandmark> MapTurn(const MapSnapshot& map, KeyFrameId id,
                                 const std::vector<NewLandmark>& made, const Camera& camera,
                                 const MapperSettings& settings) {
  const KeyFrame& a = *map.Find(id);
  std::vector<uint8_t> used(a.landmarks.size(), 0);
  size_t count = made.size();
  for (size_t i = 0; i < used.size(); ++i) {
    used[i] = a.landmarks[i].valid();
    count += used[i];
  }
  for (const NewLandmark& landmark : made) used[landmark.second.keypoint] = 1;
  if (static_cast<double>(count) >= settings.rotation_landmarks * settings.match_scale) return {};

  const double depth = MedianDepth(map, a).value_or(1);
  const Se3 T_world_a = a.T_camera_world.Inverse();
  const auto assumed = [&](int i) -> Eigen::Vector3d {
    return T_world_a * camera.Unproject(a.frame->keypoints[i].pixel(), depth);
  };
  std::vector<NewLandmark> turned;
  int searched = 0;
  for (const Neighbour& neighbour : a.covisible) {
    const KeyFrame* b = map.Find(neighbour.id);
    if (!b) continue;
    if ((b->Centre() - a.Centre()).norm() >= settings.min_baseline_ratio * depth) continue;
    if (++searched > settings.triangulate_keyframes_mono) break;
    // For each keypoint of b, its best match in a.
    std::vector<Lookalike> in_a(b->landmarks.size());
    for (int i = 0; i < static_cast<int>(used.size()); ++i) {
      if (used[i]) continue;
      const Eigen::Vector3d p = b->T_camera_world * assumed(i);
      if (p.z() <= 0) continue;
      const Lookalike found =
          LookFor(a.frame->keypoints[i], a.frame->descriptors[i], camera.Project(p), *b, settings);
      if (found.keypoint >= 0 && found.distance < in_a[found.keypoint].distance)
        in_a[found.keypoint] = {i, found.distance};
    }
    for (int j = 0; j < static_cast<int>(in_a.size()); ++j) {
      const int i = in_a[j].keypoint;
      if (i < 0 || used[i]) continue;
      if (!FitsKeypoint(camera, *b, b->frame->keypoints[j], assumed(i), settings)) continue;
      used[i] = 1;
      turned.push_back({assumed(i), {b->id, j}, {a.id, i}, false, true});
    }
  }
  return turned;
}

}  // namespace alidade
