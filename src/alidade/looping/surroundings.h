// The surroundings of a keyframe: nearby landmarks and keyframes.
#pragma once

#include <algorithm>
#include <vector>

#include "alidade/map/map_store.h"

namespace alidade {

// Landmarks observed by the keyframe and its ten best covisible keyframes, without duplicates, by
// id.
inline std::vector<LandmarkId> LandmarksAround(const MapSnapshot& map, const KeyFrame& place) {
  constexpr size_t kKeyFrames = 10;
  std::vector<LandmarkId> landmarks;
  const auto add = [&](const KeyFrame& keyframe) {
    for (LandmarkId id : keyframe.landmarks) {
      if (id.valid()) landmarks.push_back(id);
    }
  };
  add(place);
  for (size_t i = 0; i < place.covisible.size() && i < kKeyFrames; ++i) {
    add(*map.Find(place.covisible[i].id));
  }
  std::sort(landmarks.begin(), landmarks.end());
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());
  return landmarks;
}

// Covisible keyframes that share at least `tied_share` of the keyframe's landmarks, most first
// (LoopSettings::tied_share).
inline std::vector<KeyFrameId> TiedTo(const KeyFrame& keyframe, double tied_share) {
  const auto seen = std::count_if(keyframe.landmarks.begin(), keyframe.landmarks.end(),
                                  [](LandmarkId id) { return id.valid(); });
  std::vector<KeyFrameId> tied;
  for (const Neighbour& n : keyframe.covisible) {
    if (n.shared < tied_share * static_cast<double>(seen)) break;
    tied.push_back(n.id);
  }
  return tied;
}

}  // namespace alidade
