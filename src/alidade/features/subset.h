// A frame with some of its keypoints only.
#pragma once

#include <span>

#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace alidade {

// `kept`: indices of keypoints, growing; they are numbered anew in that order.
Frame KeypointSubset(const Frame& frame, std::span<const int> kept, const Camera& camera);

}  // namespace alidade
