// What a recognised place makes of the map: worked out on a snapshot, entered in one commit.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/looping/settings.h"
#include "alidade/looping/verify.h"
#include "alidade/map/correction.h"

namespace alidade {

struct LoopCorrection {
  LoopMatch match;
  std::vector<KeyFrameId> window;               // the keyframe and those around it, by id
  std::vector<FusedSighting> fused;             // landmarks of the place in the window
  std::vector<KeyFrameCorrection> corrections;  // a loop: all keyframes of the map, by id
  MapId older, younger;                         // a merge: two maps …
  Sim3 T_older_younger;                         // … and how their worlds lie
  bool merges() const { return younger.valid(); }
};

// In one map: puts the window where the match says, and spreads the difference over the map by
// optimising its essential graph: spanning tree, strong covisibility, loops (ORB-SLAM §VII-C, D).
// Between two: lays the younger map's world on the older's.
LoopCorrection CorrectLoop(const MapSnapshot& map, const LoopMatch& match, const Camera& camera,
                           const LoopSettings& settings);

// False, and nothing done, when the keyframe or the place is gone.
bool CommitLoop(MapCommit& commit, const LoopCorrection& correction);

}  // namespace alidade
