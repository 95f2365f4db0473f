// Geometric verification of a loop candidate.
#pragma once

#include <optional>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/looping/settings.h"
#include "alidade/map/fusion.h"
#include "alidade/map/map_store.h"

namespace alidade {

// `keyframe` shows the same place as `place`.
struct LoopMatch {
  KeyFrameId keyframe, place;
  Se3 T_camera_world;                // of `keyframe`, in the place's world frame and scale
  double depth = 1;                  // median depth of `keyframe`'s landmarks, in the place's scale
  double growth = 1;                 // scale factor for lengths around `keyframe` (monocular)
  std::vector<FusedSighting> found;  // landmarks of the place found in `keyframe`
  int visible = 0;                   // landmarks that were expected to be found
};

// Returns nullopt if the places differ or the match is not certain. Aligns matched landmarks by
// RANSAC, searches all landmarks of the place from there, and requires that covisible keyframes
// observe the place too. Finally checks that tracking can have drifted this far (Mur-Artal et al.
// 2015, §VII-B; Campos et al. 2021, §VI-A), or that the camera can have moved from one map to the
// other (DoubtOf(), for keyframes from `recording` on, whose times are of one clock; invalid: not
// checked).
std::optional<LoopMatch> VerifyLoop(const MapSnapshot& map, KeyFrameId keyframe, KeyFrameId place,
                                    const Camera& camera, const LoopSettings& settings,
                                    KeyFrameId recording = {});

}  // namespace alidade
