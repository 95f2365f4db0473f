// Selection of keyframes to remove when there are more than mapper.max_keyframes.
#pragma once

#include <vector>

#include "alidade/map/map_store.h"

namespace alidade {

// The `count` least valuable keyframes in order, each evaluated without those already selected;
// fewer if not enough may be removed. The value is the sum of 1 / (number of remaining keyframes
// that observe it) over its landmarks, times 0.5 (oldest) to 1 (newest), times 4 if covisible with
// `newest`, or 2 if covisible via one other keyframe (the camera's current surroundings). Never
// selects the first keyframe of a map, `newest`, or younger ones.
std::vector<KeyFrameId> FindLeastUseful(const MapSnapshot& map, KeyFrameId newest, int count);

}  // namespace alidade
