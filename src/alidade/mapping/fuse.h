// Search for duplicate landmarks and missing observations.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/fusion.h"
#include "alidade/mapping/settings.h"

namespace alidade {

// Projects the landmarks of `id` into its covisible keyframes, and theirs into it (Mur-Artal et al.
// 2015, §VI-C).
std::vector<FusedSighting> FindDuplicates(const MapSnapshot& map, KeyFrameId id,
                                          const Camera& camera, const MapperSettings& settings);

}  // namespace alidade
