// Finding known landmarks in a keyframe, and making one of two that are the same thing.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"

namespace alidade {

// `landmark` is what `keyframe` shows at `keypoint`, whatever that keypoint was thought to be.
struct FusedSighting {
  LandmarkId landmark;
  KeyFrameId keyframe;
  int keypoint = -1;
};

struct LandmarkSearch {
  double radius = 3;      // pixels on level 0, around the place where it should be seen
  int max_distance = 50;  // bits of 256
  std::optional<MeasurementNoise> gate;  // chi² test of the place (95 %); none: the radius alone
};

// Landmarks the keyframe does not show yet, where a camera at `T_camera_world` should see them.
// `visible` (may be null) is set to how many of them it should.
std::vector<FusedSighting> FindLandmarks(const MapSnapshot& map,
                                         std::span<const LandmarkId> landmarks,
                                         const KeyFrame& keyframe, const Se3& T_camera_world,
                                         const Camera& camera, const LandmarkSearch& search,
                                         int* visible = nullptr);

// Enters them: adds the observation, or merges the two landmarks into the one seen more often. What
// no longer fits is passed over. Returns the landmarks touched, sorted.
std::vector<LandmarkId> CommitFusion(MapCommit& commit,
                                     const std::vector<FusedSighting>& sightings);

}  // namespace alidade
