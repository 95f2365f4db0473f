// What the map can do without.
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
  bool doubted = false;       // since the mapper last looked
  float static_log_odds = 0;  // what was seen since it was born says so, or against it
};

// Landmarks on trial that failed: seldom found, or seen by too few keyframes since (ORB-SLAM
// §VI-B). `still_young` gets those whose trial goes on.
std::vector<LandmarkId> FindWeakLandmarks(const MapSnapshot& map,
                                          const std::vector<LandmarkId>& young,
                                          const IdMap<LandmarkId, SightingTally>& tallies,
                                          KeyFrameId newest, bool has_depth,
                                          const MapperSettings& settings,
                                          std::vector<LandmarkId>& still_young);

// Covisible keyframes of `id` nearly all of whose landmarks are seen by three others at the same or
// a finer scale (ORB-SLAM §VI-E). Judged one after the other, each without those already named;
// younger ones are not judged.
std::vector<KeyFrameId> FindRedundantKeyFrames(const MapSnapshot& map, KeyFrameId id,
                                               bool has_depth, const MapperSettings& settings);

}  // namespace alidade
