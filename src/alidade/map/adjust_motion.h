// The readings of an inertial sensor as measurements of bundle adjustment.
#pragma once

#include <vector>

#include "alidade/map/map_store.h"
#include "alidade/optimize/bundle_motion.h"

namespace alidade {

// The motions (KeyFrame::motion) between those of `keyframes` that follow each other, for a bundle
// problem with these cameras. Empty where the map's unit or gravity is not known. `scale_held`: by
// keyframes that are not adjusted, so that what is not known of it makes motions less precise.
// Standard
// deviations are divided by `noise_share`, that of the pixels which the problem assumes divided by
// what is measured: so all weights are in the same unit.
BundleMotion MotionBetween(const MapSnapshot& map, const std::vector<KeyFrameId>& keyframes,
                           bool has_meters, bool scale_held, double noise_share);

}  // namespace alidade
