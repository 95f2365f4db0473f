#include "alidade/map/view.h"

#include <vector>

#include "alidade/base/median.h"
#include "alidade/features/guided_search.h"

namespace alidade {

std::optional<LandmarkView> ViewLandmark(const Landmark& landmark, const Camera& camera,
                                         const Se3& T_camera_world, double margin) {
  const Eigen::Vector3d p = T_camera_world * landmark.p_world;
  if (p.z() <= 0.01) return {};
  LandmarkView view;
  view.pixel = camera.Project(p);
  // Written so that NaN counts as outside.
  const bool inside = view.pixel.x() >= -margin && view.pixel.x() < camera.width + margin &&
                      view.pixel.y() >= -margin && view.pixel.y() < camera.height + margin;
  if (!inside) return {};
  view.distance = p.norm();
  if (view.distance < 0.8 * landmark.min_distance || view.distance > 1.2 * landmark.max_distance)
    return {};
  const Eigen::Vector3d sight = T_camera_world.R.transpose() * p;
  view.cosine = sight.dot(landmark.normal.cast<double>()) / view.distance;
  if (view.cosine < 0.5) return {};
  if (const double bf = camera.bf(); bf > 0) view.right_x = view.pixel.x() - bf / p.z();
  view.level = PredictLevel(landmark.max_distance, view.distance);
  return view;
}

std::optional<double> MedianDepth(const MapSnapshot& map, const KeyFrame& keyframe) {
  std::vector<double> depths;
  for (LandmarkId id : keyframe.landmarks) {
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (landmark) depths.push_back((keyframe.T_camera_world * landmark->p_world).z());
  }
  if (depths.empty()) return {};
  return UpperMedian(depths);
}

int CountOfKnownScale(const MapSnapshot& map, const KeyFrame& keyframe) {
  int count = 0;
  for (LandmarkId id : keyframe.landmarks) {
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    count += landmark && landmark->scale_known;
  }
  return count;
}

bool HasMeasuredMotion(const MapSnapshot& map, const KeyFrame& keyframe) {
  const MapWorld* world = map.WorldOf(keyframe.map);
  return keyframe.motion && world && world->meters && world->KnowsDown();
}

MapId LargestMap(const MapSnapshot& map) {
  MapId largest;
  size_t most = 0;
  for (MapId id : map.Maps()) {
    const size_t count = map.KeyFramesOf(id).size();
    if (count <= most) continue;
    most = count;
    largest = id;
  }
  return largest;
}

}  // namespace alidade
