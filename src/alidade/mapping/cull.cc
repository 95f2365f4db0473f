#include "alidade/mapping/cull.h"

#include <algorithm>

namespace alidade {

std::vector<LandmarkId> FindWeakLandmarks(const MapSnapshot& map,
                                          const std::vector<LandmarkId>& young,
                                          const IdMap<LandmarkId, SightingTally>& tallies,
                                          KeyFrameId newest, bool has_depth,
                                          const MapperSettings& settings,
                                          std::vector<LandmarkId>& still_young) {
  std::vector<LandmarkId> weak;
  still_young.clear();
  const size_t too_few = has_depth ? 1 : 2;  // observations
  for (LandmarkId id : young) {
    const Landmark* landmark = map.Find(id);
    if (!landmark) continue;
    const SightingTally* known = tallies.Find(id);
    const SightingTally tally = known ? *known : SightingTally{};
    const int age = static_cast<int>(newest.value - landmark->born.value);
    if (tally.expected > 0 && tally.found < settings.min_observed_share * tally.expected) {
      weak.push_back(id);
    } else if (age >= 2 && landmark->observations.size() <= too_few) {
      weak.push_back(id);
    } else if (age < settings.trial_keyframes) {
      still_young.push_back(id);
    }
  }
  return weak;
}

std::vector<KeyFrameId> FindRedundantKeyFrames(const MapSnapshot& map, KeyFrameId id,
                                               bool has_depth, const MapperSettings& settings) {
  constexpr int kOthers = 3;
  std::vector<KeyFrameId> redundant;
  const auto named = [&](KeyFrameId k) {
    return std::find(redundant.begin(), redundant.end(), k) != redundant.end();
  };
  for (const Neighbour& n : map.Find(id)->covisible) {
    if (n.id > id) continue;  // not processed yet, and in use by the tracker
    const KeyFrame* keyframe = map.Find(n.id);
    if (!keyframe || !keyframe->parent.valid() || !keyframe->loops.empty()) continue;
    int counted = 0, covered = 0;
    for (size_t i = 0; i < keyframe->landmarks.size(); ++i) {
      const Landmark* landmark =
          keyframe->landmarks[i].valid() ? map.Find(keyframe->landmarks[i]) : nullptr;
      if (!landmark) continue;
      const Keypoint& keypoint = keyframe->frame->keypoints[i];
      if (has_depth && !keypoint.has_depth()) continue;
      ++counted;
      int others = 0;
      for (const Observation& o : landmark->observations) {
        if (o.keyframe == keyframe->id || named(o.keyframe)) continue;
        if (map.Find(o.keyframe)->frame->keypoints[o.keypoint].level <= keypoint.level + 1)
          ++others;
        if (others >= kOthers) break;
      }
      covered += others >= kOthers;
    }
    if (covered > settings.redundant_share * counted) redundant.push_back(keyframe->id);
  }
  return redundant;
}

}  // namespace alidade
