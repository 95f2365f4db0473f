#include "alidade/mapping/local_window.h"

#include <algorithm>

#include "alidade/base/id_map.h"

namespace alidade {
namespace {

// Extends `window` by keyframes that share the most landmarks with any keyframe in it, best first.
void Widen(const MapSnapshot& map, const MapperSettings& settings,
           std::vector<KeyFrameId>& window) {
  IdSet<KeyFrameId> within;
  std::vector<Neighbour> around;  // neighbors of the window's keyframes, may contain duplicates
  const auto enter = [&](KeyFrameId id) {
    within.Enter(id);
    for (const Neighbour& n : map.Find(id)->covisible) {
      if (n.shared >= settings.window_shared && map.Find(n.id)) around.push_back(n);
    }
  };
  for (KeyFrameId id : window) enter(id);
  while (static_cast<int>(window.size()) < settings.window_keyframes) {
    Neighbour best{{}, 0};
    for (const Neighbour& n : around) {
      const bool better = n.shared > best.shared || (n.shared == best.shared && n.id > best.id);
      if (better && !within.Contains(n.id)) best = n;
    }
    if (best.shared == 0) return;
    window.push_back(best.id);
    enter(best.id);
  }
}

// Adds the keyframes from which inertial readings lead to those of `free`, so that the chain of
// motions does not break.
void HoldBefore(const MapSnapshot& map, const std::vector<KeyFrameId>& free,
                std::vector<KeyFrameId>& fixed) {
  for (KeyFrameId id : free) {
    const KeyFrame& keyframe = *map.Find(id);
    if (!keyframe.motion) continue;
    const KeyFrame* since = map.Find(keyframe.motion->since);
    if (!since || since->map != keyframe.map) continue;
    if (std::binary_search(free.begin(), free.end(), since->id)) continue;
    if (std::find(fixed.begin(), fixed.end(), since->id) == fixed.end()) fixed.push_back(since->id);
  }
}

}  // namespace

Adjustment AdjustWindow(const MapSnapshot& map, KeyFrameId id, const Camera& camera,
                        const MapperSettings& settings, const std::atomic<bool>* stop) {
  const KeyFrame& newest = *map.Find(id);
  std::vector<KeyFrameId> free{id};
  for (const Neighbour& n : newest.covisible) {
    if (static_cast<int>(free.size()) >= settings.window_keyframes) break;
    if (map.Find(n.id)) free.push_back(n.id);
  }
  const bool one_camera = camera.StereoBaseline() <= 0;
  if (one_camera) Widen(map, settings, free);
  std::sort(free.begin(), free.end());

  // Candidates for fixed keyframes: number of the window's landmarks that each outside keyframe
  // observes.
  IdMap<KeyFrameId, int> votes;
  IdSet<LandmarkId> counted;
  for (KeyFrameId keyframe : free) {
    for (LandmarkId landmark_id : map.Find(keyframe)->landmarks) {
      if (!landmark_id.valid() || !counted.Enter(landmark_id)) continue;
      if (const Landmark* landmark = map.Find(landmark_id)) {
        for (const Observation& o : landmark->observations) ++votes[o.keyframe];
      }
    }
  }
  std::vector<Neighbour> outside;
  for (const auto& [keyframe, count] : votes.entries()) {
    if (!std::binary_search(free.begin(), free.end(), keyframe))
      outside.push_back({keyframe, count});
  }
  std::sort(outside.begin(), outside.end(), [](const Neighbour& a, const Neighbour& b) {
    return a.shared != b.shared ? a.shared > b.shared : a.id < b.id;
  });
  std::vector<KeyFrameId> fixed;
  for (const Neighbour& n : outside) {
    if (static_cast<int>(fixed.size()) >= settings.window_fixed) break;
    fixed.push_back(n.id);
  }
  // Gauge: the first keyframe of a map stays fixed, and at least one keyframe (two if monocular,
  // for the scale).
  const size_t wanted = one_camera ? 2 : 1;
  while (fixed.size() < wanted && free.size() > 1) {
    fixed.push_back(free.front());
    free.erase(free.begin());
  }
  if (!map.Find(free.front())->parent.valid() && free.size() > 1) {
    fixed.push_back(free.front());
    free.erase(free.begin());
  }
  HoldBefore(map, free, fixed);
  std::sort(fixed.begin(), fixed.end());
  AdjustSettings adjust{settings.noise, settings.bundle, settings.min_noise_ratio,
                        settings.assumed_depth_error, settings.assumed_depth_degrees};
  if (one_camera) adjust.bundle.max_iterations = settings.window_iterations_mono;
  return AdjustKeyFrames(map, free, fixed, camera, adjust, stop, id);
}

}  // namespace alidade
