// Landmarks that are the same thing twice, and sightings nobody noticed.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/settings.h"

namespace alidade {

// `landmark` is what `keyframe` shows at `keypoint`, whatever that keypoint was thought to be.
struct FusedSighting {
  LandmarkId landmark;
  KeyFrameId keyframe;
  int keypoint = -1;
};

// Projects the landmarks of `id` into its covisible keyframes, and theirs into it (ORB-SLAM §VI-C).
std::vector<FusedSighting> FindDuplicates(const MapSnapshot& map, KeyFrameId id,
                                          const Camera& camera, const MapperSettings& settings);

// Enters them: adds the observation, or merges the two landmarks into the one seen more often. What
// no longer fits is passed over. Returns the landmarks touched, sorted.
std::vector<LandmarkId> CommitFusion(MapCommit& commit,
                                     const std::vector<FusedSighting>& sightings);

}  // namespace alidade
