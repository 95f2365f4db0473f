#include "alidade/run/export/map_models.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "alidade/base/print.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

// Times are not unique if a recording was added to the map of another: -2, -3, … is appended then.
std::string FreshName(double time, std::set<std::string>& taken) {
  const std::string stem = ShortTime(time);
  std::string name = stem + ".png";
  for (int i = 2; !taken.insert(name).second; ++i) name = stem + "-" + std::to_string(i) + ".png";
  return name;
}

}  // namespace

std::string ShortTime(double seconds) {
  std::string text;
  for (int digits = 6; digits <= 9; ++digits) {
    char buffer[400];  // holds any double
    PrintTo(buffer, sizeof(buffer), "%.*f", digits, seconds);
    text = buffer;
    if (ParseNumber(text) == seconds) break;
  }
  return text;
}

Trajectory TrajectoryOf(const SavedMap& saved, const MapPart& part) {
  Trajectory trajectory;
  for (KeyFrameId id : part.keyframes) {
    const KeyFrame& keyframe = *saved.map.Find(id);
    trajectory.push_back(
        {keyframe.frame->time, keyframe.T_camera_world.Inverse(), ShortTime(keyframe.frame->time)});
  }
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
  return trajectory;
}

MapPart SeenOften(const SavedMap& saved, MapPart part, int min_observations) {
  std::erase_if(part.landmarks, [&](LandmarkId id) {
    return static_cast<int>(saved.map.Find(id)->observations.size()) < min_observations;
  });
  return part;
}

Cloud CloudOf(const SavedMap& saved, const MapPart& part) {
  Cloud cloud;
  for (LandmarkId id : part.landmarks) {
    cloud.points.push_back(saved.map.Find(id)->p_world.cast<float>());
  }
  return cloud;
}

ColmapModel::Point PointOf(
    const ColmapModel& model, const Landmark& landmark,
    const std::function<std::optional<ColmapModel::Seen>(const Observation&)>& place) {
  ColmapModel::Point point;
  point.p_world = landmark.p_world;
  double sum = 0;
  int in_front = 0;
  for (const Observation& observation : landmark.observations) {
    const std::optional<ColmapModel::Seen> seen = place(observation);
    if (!seen) continue;
    point.track.push_back(*seen);
    const ColmapModel::Image& image = model.images[static_cast<size_t>(seen->image)];
    const Eigen::Vector3d p_camera = image.T_camera_world * landmark.p_world;
    if (!(p_camera.z() > 0)) continue;
    const Eigen::Vector2d pixel = model.camera.Distort(model.camera.Project(p_camera));
    sum += (pixel - image.keypoints[static_cast<size_t>(seen->keypoint)].pixel).norm();
    ++in_front;
  }
  if (in_front > 0) point.error = sum / in_front;
  return point;
}

void AddPoint(ColmapModel& model, ColmapModel::Point point) {
  for (const ColmapModel::Seen& seen : point.track) {
    model.images[static_cast<size_t>(seen.image)]
        .keypoints[static_cast<size_t>(seen.keypoint)]
        .point = static_cast<int>(model.points.size());
  }
  model.points.push_back(std::move(point));
}

ColmapModel ColmapModelOf(const SavedMap& saved, const MapPart& part) {
  ColmapModel model;
  model.camera = saved.camera;
  std::map<KeyFrameId, int> images;
  std::set<std::string> names;
  for (KeyFrameId id : part.keyframes) {
    const KeyFrame& keyframe = *saved.map.Find(id);
    images[id] = static_cast<int>(model.images.size());
    ColmapModel::Image image{FreshName(keyframe.frame->time, names), keyframe.T_camera_world, {}};
    for (const Keypoint& keypoint : keyframe.frame->keypoints) {
      image.keypoints.push_back({{keypoint.raw_x, keypoint.raw_y}});
    }
    model.images.push_back(std::move(image));
  }
  const auto place = [&](const Observation& seen) -> std::optional<ColmapModel::Seen> {
    const auto image = images.find(seen.keyframe);
    if (image == images.end()) return std::nullopt;
    return ColmapModel::Seen{image->second, seen.keypoint};
  };
  for (LandmarkId id : part.landmarks) AddPoint(model, PointOf(model, *saved.map.Find(id), place));
  return model;
}

}  // namespace alidade
