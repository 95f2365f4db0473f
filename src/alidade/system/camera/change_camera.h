// Gives a saved map another calibration of its camera.
#pragma once

#include <functional>

#include "alidade/map/map_file.h"
#include "alidade/map/map_store.h"
#include "alidade/system/settings.h"

namespace alidade {

// Adjusts all keyframes and landmarks of one map, removes outliers, and adjusts once more. The root
// keyframe stays where it is. `step` (may be empty) is called before each round.
void AdjustWholeMap(MapStore& store, MapId id, const Camera& camera, const SlamSettings& settings,
                    const std::function<void(const char* what, int keyframes)>& step);

// `saved` as if it had been made with `camera`: its keypoints are undistorted anew from their
// positions in the image (what was corrected for a rolling shutter is kept), then each map is
// adjusted. For maps without depth and for similar cameras (MayBeOneCamera()).
SavedMap WithCamera(const SavedMap& saved, const Camera& camera, const SlamSettings& settings);

}  // namespace alidade
