// Probability of each feature to be static, from the belief of the cells around it.
#pragma once

#include <span>
#include <vector>

#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/frame_belief.h"
#include "alidade/dynamics/settings.h"
#include "alidade/features/depth_image.h"
#include "alidade/features/frame.h"

namespace alidade {

// One probability per keypoint. `depth`: the frame's depth image; may be empty even if `belief` has
// depth (stereo).
std::vector<float> StaticProbabilities(const Cells& cells, const FrameBelief& belief,
                                       const DepthImage& depth, std::span<const Keypoint> keypoints,
                                       const DynamicsSettings& settings);

}  // namespace alidade
