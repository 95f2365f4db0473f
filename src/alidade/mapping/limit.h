// Which keyframes go when there are more than may be (mapper.max_keyframes).
#pragma once

#include <vector>

#include "alidade/map/map_store.h"

namespace alidade {

// The `count` least useful keyframes, in order, each judged without those already named; fewer when
// there are not so many that may go. A keyframe is worth the sightings it holds: the sum of
// 1 / (keyframes left that see it) over its landmarks, times a half for the oldest to one for the
// newest, times four when it shares landmarks with `newest`, two when it does over one other: that
// is the place where the camera is. Never named: the first of a map, `newest` and what is younger.
std::vector<KeyFrameId> FindLeastUseful(const MapSnapshot& map, KeyFrameId newest, int count);

}  // namespace alidade
