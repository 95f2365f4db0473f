// A synthetic world as odometry would map it: keyframes that drift along the way, and landmarks
// that are made a second time when they come into sight again after long.
#pragma once

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "alidade/map/map_store.h"
#include "problems/synthetic_world.h"

namespace alidade {

struct DriftedMapSettings {
  Vector6d drift = Vector6d::Zero();  // of each step, metres and radians: T <- Exp(drift) * T
  double growth = 1;                  // of each step: what lengths are multiplied by from there on
  int drift_first = 1;                // the first step that drifts, and …
  int drift_last = 1 << 30;           // … the last
  int first = 0, count = 1 << 30;     // the views that are mapped
  int forgotten_after = 8;            // steps out of sight, then a point becomes a new landmark
  Sim3 T_map_world = {};              // the map's world, seen from the true one
};

struct DriftedMap {
  std::vector<KeyFrameId> keyframes;                  // of the views mapped
  std::vector<double> scales;                         // of lengths around them to true ones
  std::vector<std::pair<LandmarkId, int>> landmarks;  // with the point it shows
};

// Each keyframe is the child of the one before. Landmarks lie where the first keyframe that sees
// them puts them.
inline DriftedMap FillDriftedMap(const SyntheticWorld& world, const DriftedMapSettings& settings,
                                 MapStore& store) {
  DriftedMap made;
  struct Seen {
    std::vector<Observation> observations;
    int first = 0, last = 0;  // views
  };
  std::map<int, std::vector<Seen>> seen;  // of each point: its appearances
  const int end =
      static_cast<int>(std::min<int64_t>(static_cast<int64_t>(world.views.size()),
                                         static_cast<int64_t>(settings.first) + settings.count));
  store.Commit([&](MapCommit& commit) {
    Se3 pose, before;
    std::vector<Se3> poses;
    double scale = settings.T_map_world.s;
    for (int v = settings.first; v < end; ++v) {
      const SyntheticView& view = world.views[v];
      if (v == settings.first) {
        pose = InOtherWorld(view.T_camera_world, settings.T_map_world);
      } else {
        const bool drifts = v >= settings.drift_first && v <= settings.drift_last;
        if (drifts) scale *= settings.growth;
        Se3 step = view.T_camera_world * before.Inverse();
        step.t *= scale;
        pose = (drifts ? Se3::Exp(settings.drift) * step : step) * pose;
      }
      before = view.T_camera_world;
      KeyFrame keyframe;
      keyframe.frame = view.frame;
      keyframe.T_camera_world = pose;
      if (!made.keyframes.empty()) keyframe.parent = made.keyframes.back();
      made.keyframes.push_back(commit.Add(std::move(keyframe)));
      made.scales.push_back(scale);
      poses.push_back(pose);
      for (size_t k = 0; k < view.points.size(); ++k) {
        if (view.points[k] < 0) continue;
        auto& appearances = seen[view.points[k]];
        if (appearances.empty() || appearances.back().last < v - settings.forgotten_after)
          appearances.push_back({{}, v, v});
        appearances.back().last = v;
        appearances.back().observations.push_back({made.keyframes.back(), static_cast<int>(k)});
      }
    }
    for (const auto& [point, appearances] : seen) {
      for (const Seen& appearance : appearances) {
        if (appearance.observations.size() < 2) continue;
        const int i = appearance.first - settings.first;
        const Eigen::Vector3d p_camera =
            world.views[appearance.first].T_camera_world * world.points[point];
        Landmark landmark;
        landmark.p_world = poses[i].Inverse() * Eigen::Vector3d(made.scales[i] * p_camera);
        landmark.observations = appearance.observations;
        landmark.reference = landmark.born = made.keyframes[i];
        made.landmarks.push_back({commit.Add(std::move(landmark)), point});
        commit.RefreshLandmark(made.landmarks.back().first);
      }
    }
    for (KeyFrameId id : made.keyframes) commit.RefreshCovisibility(id);
  });
  return made;
}

}  // namespace alidade
