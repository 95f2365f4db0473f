// A synthetic world as a map that knows the truth, or some of it.
#pragma once

#include <map>
#include <vector>

#include "alidade/map/map_store.h"
#include "problems/synthetic_world.h"

namespace alidade {

struct SyntheticMapSettings {
  double known = 1;        // share of the points that are landmarks
  double pose_sigma = 0;   // metres and radians, of every keyframe but the first two
  double point_sigma = 0;  // metres
  int keyframes = -1;      // the first so many views; -1: all
  uint64_t seed = 7;
};

struct SyntheticMap {
  std::vector<KeyFrameId> keyframes;  // of the views
  std::vector<LandmarkId> landmarks;  // of the points; none where not known
};

// Enters views as keyframes, each the child of the one before, and the points at least two of them
// see as landmarks.
inline SyntheticMap FillMap(const SyntheticWorld& world, const SyntheticMapSettings& settings,
                            MapStore& store) {
  Random random(settings.seed);
  const auto noise = [&](double sigma) {
    const double x = random.Gaussian(), y = random.Gaussian(), z = random.Gaussian();
    return Eigen::Vector3d(sigma * Eigen::Vector3d(x, y, z));
  };
  const size_t count =
      settings.keyframes < 0 ? world.views.size() : static_cast<size_t>(settings.keyframes);
  SyntheticMap made;
  made.landmarks.resize(world.points.size());
  store.Commit([&](MapCommit& commit) {
    std::map<int, std::vector<Observation>> observations;  // of each point
    for (size_t v = 0; v < count; ++v) {
      KeyFrame keyframe;
      keyframe.frame = world.views[v].frame;
      Vector6d xi;
      xi << noise(settings.pose_sigma), noise(settings.pose_sigma);
      if (v < 2) xi.setZero();
      keyframe.T_camera_world = Se3::Exp(xi) * world.views[v].T_camera_world;
      if (v > 0) keyframe.parent = made.keyframes.back();
      made.keyframes.push_back(commit.Add(std::move(keyframe)));
      for (size_t k = 0; k < world.views[v].points.size(); ++k) {
        const int point = world.views[v].points[k];
        if (point >= 0) observations[point].push_back({made.keyframes.back(), static_cast<int>(k)});
      }
    }
    for (const auto& [point, seen] : observations) {
      if (seen.size() < 2 || random.Uniform() >= settings.known) continue;
      Landmark landmark;
      landmark.p_world = world.points[point] + noise(settings.point_sigma);
      landmark.observations = seen;
      landmark.reference = landmark.born = seen.front().keyframe;
      made.landmarks[point] = commit.Add(std::move(landmark));
      commit.RefreshLandmark(made.landmarks[point]);
    }
    for (KeyFrameId id : made.keyframes) commit.RefreshCovisibility(id);
  });
  return made;
}

}  // namespace alidade
