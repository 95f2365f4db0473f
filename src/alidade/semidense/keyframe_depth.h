// Semi-dense depth of one keyframe from its partners.
#pragma once

#include <array>
#include <vector>

#include "alidade/semidense/depth_range.h"
#include "alidade/semidense/epipolar_search.h"
#include "alidade/semidense/settings.h"

namespace alidade {

// Searches the partners in order (smallest parallax first, each narrowing the search in later
// ones), then fuses and smooths. Returns one hypothesis per edge of the reference. `count` (may be
// null) accumulates statistics.
std::vector<Hypothesis> DepthFromMotion(const std::vector<EpipolarPair>& pairs,
                                        const Camera& camera, const DepthRange& range,
                                        const SemiDenseSettings& settings,
                                        SearchCount* count = nullptr);

}  // namespace alidade
