// The readings of an inertial sensor as measurements of bundle adjustment.
#pragma once

#include <vector>

#include "alidade/map/map_store.h"
#include "alidade/optimize/bundle_motion.h"

namespace alidade {

// The motions (KeyFrame::motion) between those of `keyframes` that follow each other, for a bundle
// problem with these cameras. Empty where the map's unit or gravity is not known. `scale_held`: by
// keyframes that are not adjusted, so that what is not known of it makes motions less precise.
BundleMotion MotionBetween(const MapSnapshot& map, const std::vector<KeyFrameId>& keyframes,
                           bool has_meters, bool scale_held);

// Divides standard deviations by `noise_share` (at least 0.2, at most 1), that of the pixels as
// measured divided by what the problem assumes: so all weights are in the same unit.
void WeighBy(double noise_share, BundleMotion& motion);

}  // namespace alidade
