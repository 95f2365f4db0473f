// Loop candidates: keyframes that may show the same place as a new keyframe (Mur-Artal et al. 2015,
// §VII-A).
#pragma once

#include <functional>
#include <vector>

#include "alidade/looping/settings.h"
#include "alidade/map/map_store.h"
#include "alidade/place/place_index.h"

namespace alidade {

// Best first. Excludes keyframes connected to `id` by covisibility, directly or via one other
// keyframe; those much less similar than its best covisible keyframe; and all but the most similar
// one of a group of covisible candidates. `may_be` (empty: any) filters further; it must not call
// the index.
std::vector<KeyFrameId> FindLoopCandidates(const MapSnapshot& map, const PlaceIndex& places,
                                           KeyFrameId id, const LoopSettings& settings,
                                           const std::function<bool(KeyFrameId)>& may_be = {});

}  // namespace alidade
