// One camera that turns on the spot past little that is known: landmarks without a depth.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/triangulate.h"

namespace alidade {

// For a keyframe with fewer than settings.turn_landmarks (by match_scale), those in `made` counted:
// what it shares with covisible keyframes too near to triangulate from (min_baseline_ratio),
// assumed as deep as the median of what it sees. Such landmarks hold the rotation; they say next to
// nothing of the position, and their scale is not known. Keypoints that `made` uses are left alone.
std::vector<NewLandmark> MapTurn(const MapSnapshot& map, KeyFrameId id,
                                 const std::vector<NewLandmark>& made, const Camera& camera,
                                 const MapperSettings& settings);

}  // namespace alidade
