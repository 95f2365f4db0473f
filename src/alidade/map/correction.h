// Moving large parts of the map at once: what a closed loop or a merge asks for.
#pragma once

#include <vector>

#include "alidade/map/map_store.h"

namespace alidade {

struct KeyFrameCorrection {
  KeyFrameId id;
  Se3 T_camera_world;  // its new place
  double growth = 1;   // lengths around it are multiplied by this
};

// `corrections` sorted by id. Keyframes that are not among them follow their parent (those born
// since the corrections were worked out), landmarks their reference keyframe, all with their scale.
void CommitCorrections(MapCommit& commit, const std::vector<KeyFrameCorrection>& corrections);

// Puts all of `younger` into the world of `older`: p_older = T_older_younger * p_younger. Its first
// keyframe becomes a descendant of `anchor`, which is in `older`.
void CommitMerge(MapCommit& commit, MapId younger, MapId older, const Sim3& T_older_younger,
                 KeyFrameId anchor);

}  // namespace alidade
