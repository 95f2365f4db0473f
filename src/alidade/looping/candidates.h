// Which keyframes may show the place a new keyframe shows (ORB-SLAM §VII-A).
#pragma once

#include <functional>
#include <vector>

#include "alidade/looping/settings.h"
#include "alidade/map/map_store.h"
#include "alidade/place/place_index.h"

namespace alidade {

// Best first. Left out: what is covisible with `id`, directly or over one keyframe between, what is
// much less like it than its best covisible keyframe, and all but the likest of a group of
// covisible ones. `may_be` (empty: any) narrows them down; it must not call back into the index.
std::vector<KeyFrameId> FindLoopCandidates(const MapSnapshot& map, const PlaceIndex& places,
                                           KeyFrameId id, const LoopSettings& settings,
                                           const std::function<bool(KeyFrameId)>& may_be = {});

}  // namespace alidade
