// Landmarks with an assumed depth, for a monocular camera in pure rotation with few known
// landmarks.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/triangulate.h"

namespace alidade {

// Only for a keyframe with fewer than settings.rotation_landmarks (scaled by match_scale),
// including those in `made`. Matches keypoints with covisible keyframes at too small a baseline to
// triangulate (min_baseline_ratio), and assumes the keyframe's median depth. Such landmarks
// constrain the rotation, but hardly the position, and their scale is unknown. Keypoints used by
// `made` are skipped.
std::vector<NewLandmark> MapTurn(const MapSnapshot& map, KeyFrameId id,
                                 const std::vector<NewLandmark>& made, const Camera& camera,
                                 const MapperSettings& settings);

}  // namespace alidade
