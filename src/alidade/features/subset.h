// Copy of a frame with a subset of its keypoints.
#pragma once

#include <span>

#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace alidade {

// `kept`: ascending keypoint indices; the copies are renumbered in that order.
Frame KeypointSubset(const Frame& frame, std::span<const int> kept, const Camera& camera);

}  // namespace alidade
