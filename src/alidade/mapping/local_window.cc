#include "alidade/mapping/local_window.h"

#include <algorithm>

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
  std::vector<int> votes(map.next_keyframe(), 0);
  std::vector<uint8_t> counted(map.next_landmark(), 0);
  for (KeyFrameId keyframe : free) {
    for (LandmarkId landmark_id : map.Find(keyframe)->landmarks) {
      if (!landmark_id.valid() || counted[landmark_id.value]) continue;
      counted[landmark_id.value] = 1;
      if (const Landmark* landmark = map.Find(landmark_id)) {
        for (const Observation& o : landmark->observations) ++votes[o.keyframe.value];
      }
    }
  }
  for (KeyFrameId keyframe : free) votes[keyframe.value] = 0;
  std::vector<Neighbour> outside;
  for (uint32_t i = 0; i < votes.size(); ++i) {
    if (votes[i] > 0) outside.push_back({{i}, votes[i]});
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
