// Consistency check of a keyframe's semi-dense depth with its landmarks. Both are estimated
// independently and disagree where poses do not fit the images, e.g. after a pure rotation or in a
// wrong map.
#pragma once

#include <span>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

// True if at least ten landmarks have semi-dense depth within two pixels (the most similar one
// counts) and for three quarters of them the inverse depths differ by at most `max_difference`,
// relative to the landmark's inverse depth, or to that of the median depth for more distant
// landmarks. `depth`: one per entry of `edges`, possibly unknown, in map units.
bool AgreesWithLandmarks(const MapSnapshot& map, const KeyFrame& keyframe,
                         std::span<const EdgePixel> edges, std::span<const Hypothesis> depth,
                         const Camera& camera, double max_difference);

}  // namespace alidade
