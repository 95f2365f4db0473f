#include "alidade/gles/extent.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace alidade::gles {
namespace {

constexpr size_t kSamples = 400;

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Calls f(keyframe, landmark) for a subsample of the landmarks of the active map.
template <typename F>
void ForSome(const StreamScene& scene, F&& f) {
  const MapId active = scene.ActiveMap();
  const size_t every = std::max<size_t>(1, scene.landmarks.size() / kSamples);
  size_t i = 0;
  for (const auto& [id, landmark] : scene.landmarks) {
    if (i++ % every != 0) continue;
    const auto keyframe = scene.keyframes.find(landmark.keyframe);
    if (keyframe != scene.keyframes.end() && keyframe->second.map == active)
      f(keyframe->second, landmark);
  }
}

}  // namespace

double TypicalDistance(const StreamScene& scene) {
  std::vector<double> distances;
  ForSome(scene, [&](const SceneKeyFrame& keyframe, const SceneLandmark& landmark) {
    distances.push_back(keyframe.scale * landmark.p.cast<double>().norm());
  });
  const double typical = distances.empty() ? 1 : MedianOf(std::move(distances));
  return typical > 0 ? std::exp2(std::round(8 * std::log2(typical)) / 8) : 1;
}

Extent ExtentOf(const StreamScene& scene) {
  std::vector<Eigen::Vector3d> points;
  const MapId active = scene.ActiveMap();
  for (const auto& [id, keyframe] : scene.keyframes)
    if (keyframe.map == active) points.push_back(keyframe.T_world_camera.t);
  const auto cameras = static_cast<std::ptrdiff_t>(points.size());
  ForSome(scene, [&](const SceneKeyFrame&, const SceneLandmark& landmark) {
    points.push_back(scene.PointOf(landmark));
  });
  Extent extent;
  if (points.empty()) return extent;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), values.begin(),
                   [axis](const Eigen::Vector3d& p) { return p(axis); });
    extent.centre(axis) = MedianOf(values);
  }
  std::transform(points.begin(), points.end(), values.begin(),
                 [&](const Eigen::Vector3d& p) { return (p - extent.centre).norm(); });
  const double farthest =
      cameras > 0 ? *std::max_element(values.begin(), values.begin() + cameras) : 0;
  std::sort(values.begin(), values.end());
  const double radius = std::max(farthest, values[(values.size() - 1) * 9 / 10]);
  if (radius > 0) extent.radius = radius;
  return extent;
}

}  // namespace alidade::gles
