// Selection of landmarks and keyframes to remove.
#pragma once

#include <vector>

#include "alidade/base/id_map.h"
#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/settings.h"

namespace alidade {

// How often a landmark was expected in a frame, and found.
struct SightingTally {
  uint32_t expected = 0, found = 0;
  bool doubted = false;       // evidence was added since the last Process()
  float static_log_odds = 0;  // accumulated evidence since its creation
};

// Recent landmarks that fail their probation: rarely found, or observed by too few keyframes
// (Mur-Artal et al. 2015, §VI-B). `still_young` receives those that remain on probation.
std::vector<LandmarkId> FindWeakLandmarks(const MapSnapshot& map,
                                          const std::vector<LandmarkId>& young,
                                          const IdMap<LandmarkId, SightingTally>& tallies,
                                          KeyFrameId newest, bool has_depth,
                                          const MapperSettings& settings,
                                          std::vector<LandmarkId>& still_young);

// Covisible keyframes of `id` of whose landmarks nearly all are observed by three other keyframes
// at the same or a finer scale (Mur-Artal et al. 2015, §VI-E). Evaluated one after the other, not
// counting those already selected; younger keyframes than `id` are not considered.
std::vector<KeyFrameId> FindRedundantKeyFrames(const MapSnapshot& map, KeyFrameId id,
                                               bool has_depth, const MapperSettings& settings);

}  // namespace alidade
