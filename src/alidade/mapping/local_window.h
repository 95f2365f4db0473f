// The part of the map that a new keyframe can improve.
#pragma once

#include <atomic>

#include "alidade/geometry/camera.h"
#include "alidade/map/adjust.h"
#include "alidade/mapping/settings.h"

namespace alidade {

// Adjusts `id`, its best covisible keyframes and all they see; keyframes that see the same
// landmarks from outside hold the gauge (ORB-SLAM §VI-D). `map` is not changed. `stop` may be null.
Adjustment AdjustWindow(const MapSnapshot& map, KeyFrameId id, const Camera& camera,
                        const MapperSettings& settings, const std::atomic<bool>* stop);

}  // namespace alidade
