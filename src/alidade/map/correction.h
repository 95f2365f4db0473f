// Commits that move large parts of the map, for a loop closure or a merge.
#pragma once

#include <vector>

#include "alidade/map/map_store.h"

namespace alidade {

struct KeyFrameCorrection {
  KeyFrameId id;
  Se3 T_camera_world;  // new pose
  double growth = 1;   // scale factor of lengths around the keyframe
};

// Moves the given keyframes (`corrections` is sorted by id). All other keyframes (created since the
// corrections were computed) follow their parent, landmarks their reference keyframe, including the
// scale.
void CommitCorrections(MapCommit& commit, const std::vector<KeyFrameCorrection>& corrections);

// Moves the map `younger` into the world frame of `older`: p_older = T_older_younger * p_younger.
// Its first keyframe becomes a descendant of `anchor`, a keyframe of `older`. What is known of the
// world of `older` holds (MapWorld); the vertical is taken over from `younger` if only that knows
// it.
void CommitMerge(MapCommit& commit, MapId younger, MapId older, const Sim3& T_older_younger,
                 KeyFrameId anchor);

}  // namespace alidade
