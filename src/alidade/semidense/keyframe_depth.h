// What one keyframe goes through on its way to semi-dense depth.
#pragma once

#include <array>
#include <vector>

#include "alidade/semidense/depth_range.h"
#include "alidade/semidense/epipolar_search.h"
#include "alidade/semidense/settings.h"

namespace alidade {

// From its partners, those with the least parallax first, which later ones are narrowed by:
// searched, fused, smoothed. One hypothesis for each of the reference's edges.
std::vector<Hypothesis> DepthFromMotion(const std::vector<EpipolarPair>& pairs,
                                        const Camera& camera, const DepthRange& range,
                                        const SemiDenseSettings& settings,
                                        SearchCount* count = nullptr);

}  // namespace alidade
