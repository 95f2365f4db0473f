// How likely each feature is part of what stands still, by what is believed of the cells around it.
#pragma once

#include <span>
#include <vector>

#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/frame_belief.h"
#include "alidade/dynamics/settings.h"
#include "alidade/features/depth_image.h"
#include "alidade/features/frame.h"

namespace alidade {

// Probability of each keypoint. `depth`: the frame's depth image, which may be empty though cells
// have depth (of two cameras).
std::vector<float> StaticProbabilities(const Cells& cells, const FrameBelief& belief,
                                       const DepthImage& depth, std::span<const Keypoint> keypoints,
                                       const DynamicsSettings& settings);

}  // namespace alidade
