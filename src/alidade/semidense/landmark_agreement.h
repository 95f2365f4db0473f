// Whether landmarks lie where a keyframe's semi-dense depth says. They were found another way, so
// that the two part where poses do not fit the images: a camera that only turned, a map that is
// wrong.
#pragma once

#include <span>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

// True when at least ten landmarks have depth beside them (within two pixels; the best of it) and
// three quarters differ from it by `max_difference` at most: of inverse depth, as a share, of the
// landmarks' median for what is farther. `depth`: one for each of `edges`, of known or unknown
// depth, in the map's unit.
bool AgreesWithLandmarks(const MapSnapshot& map, const KeyFrame& keyframe,
                         std::span<const EdgePixel> edges, std::span<const Hypothesis> depth,
                         const Camera& camera, double max_difference);

}  // namespace alidade
