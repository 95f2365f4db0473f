// Correction of the map after place recognition: computed on a snapshot, applied in one commit.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/looping/settings.h"
#include "alidade/looping/verify.h"
#include "alidade/map/correction.h"

namespace alidade {

struct LoopCorrection {
  LoopMatch match;
  std::vector<KeyFrameId> window;    // the keyframe and its neighbors, by id
  std::vector<FusedSighting> fused;  // landmarks of the place found in the window
  // Loop: new poses of all keyframes of the map, by id.
  std::vector<KeyFrameCorrection> corrections;
  MapId older, younger;  // merge: the two maps
  Sim3 T_older_younger;  // merge: transform between their worlds
  bool merges() const { return younger.valid(); }
};

// Loop within a map: moves the window to the matched pose and distributes the difference by
// optimizing the essential graph (spanning tree, strong covisibility, loop edges; Mur-Artal et al.
// 2015, §VII-C, D). Two maps: computes the transform from the younger map's world to the older's.
LoopCorrection CorrectLoop(const MapSnapshot& map, const LoopMatch& match, const Camera& camera,
                           const LoopSettings& settings);

// Returns false without any effect if the keyframe or the place no longer exists.
bool CommitLoop(MapCommit& commit, const LoopCorrection& correction);

}  // namespace alidade
