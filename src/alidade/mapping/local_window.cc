#include "alidade/mapping/local_window.h"

#include <algorithm>

#include "alidade/base/id_map.h"

namespace alidade {

Adjustment AdjustWindow(const MapSnapshot& map, KeyFrameId id, const Camera& camera,
                        const MapperSettings& settings, const std::atomic<bool>* stop) {
  const KeyFrame& newest = *map.Find(id);
  std::vector<KeyFrameId> free{id};
  for (const Neighbour& n : newest.covisible) {
    if (static_cast<int>(free.size()) >= settings.window_keyframes) break;
    if (map.Find(n.id)) free.push_back(n.id);
  }
  std::sort(free.begin(), free.end());

  // Votes for the fixed ones: landmarks of the window each outsider sees.
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
  // The world's own frame stays; something must hold a young map's gauge (and a monocular one's
  // scale).
  const size_t wanted = camera.StereoBaseline() > 0 ? 1 : 2;
  while (fixed.size() < wanted && free.size() > 1) {
    fixed.push_back(free.front());
    free.erase(free.begin());
  }
  if (!map.Find(free.front())->parent.valid() && free.size() > 1) {
    fixed.push_back(free.front());
    free.erase(free.begin());
  }
  std::sort(fixed.begin(), fixed.end());
  return AdjustKeyFrames(map, free, fixed, camera, {settings.noise, settings.bundle}, stop);
}

}  // namespace alidade
