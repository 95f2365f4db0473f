// Searches landmarks in a keyframe and merges duplicate landmarks.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"

namespace alidade {

// `landmark` was found at `keypoint` of `keyframe`; the keypoint may already observe another
// landmark.
struct FusedSighting {
  LandmarkId landmark;
  KeyFrameId keyframe;
  int keypoint = -1;
};

struct LandmarkSearch {
  double radius = 3;      // search radius around the predicted position, pixels on level 0
  int max_distance = 50;  // Hamming distance, bits of 256
  // Noise for a chi² test of the position (95 %); none: the radius only.
  std::optional<MeasurementNoise> gate;
};

// Finds landmarks that the keyframe does not observe yet in a camera at `T_camera_world`. `visible`
// (may be null) receives the number of landmarks predicted to be visible.
std::vector<FusedSighting> FindLandmarks(const MapSnapshot& map,
                                         std::span<const LandmarkId> landmarks,
                                         const KeyFrame& keyframe, const Se3& T_camera_world,
                                         const Camera& camera, const LandmarkSearch& search,
                                         int* visible = nullptr);

// Commits the matches: adds the observation, or merges two landmarks into the one with more
// observations. Skips matches that are no longer possible. Returns the ids of the changed
// landmarks, sorted.
std::vector<LandmarkId> CommitFusion(MapCommit& commit,
                                     const std::vector<FusedSighting>& sightings);

}  // namespace alidade
