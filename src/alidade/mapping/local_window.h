// Local bundle adjustment around a new keyframe.
#pragma once

#include <atomic>

#include "alidade/geometry/camera.h"
#include "alidade/map/adjust.h"
#include "alidade/mapping/settings.h"

namespace alidade {

// Adjusts `id`, its best covisible keyframes and all landmarks they observe; outside keyframes that
// observe the same landmarks are fixed (Mur-Artal et al. 2015, §VI-D). `map` is not changed. `stop`
// (may be null) ends it early.
Adjustment AdjustWindow(const MapSnapshot& map, KeyFrameId id, const Camera& camera,
                        const MapperSettings& settings, const std::atomic<bool>* stop);

}  // namespace alidade
