// What an old place must show before it is believed to be the one in view.
#pragma once

#include <optional>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/looping/settings.h"
#include "alidade/map/fusion.h"
#include "alidade/map/map_store.h"

namespace alidade {

// `keyframe` sees what `place` saw.
struct LoopMatch {
  KeyFrameId keyframe, place;
  Se3 T_camera_world;  // of `keyframe` by the place's landmarks, in the place's world and scale
  double depth = 1;    // median, of what `keyframe` sees, in the place's scale
  double growth = 1;   // lengths around `keyframe` must be multiplied by this (monocular)
  std::vector<FusedSighting> found;  // landmarks of the place, in `keyframe`
  int visible = 0;                   // of them that should have been found
};

// nullopt: not the same place, or not certain enough. Alignment of matched landmarks by RANSAC, all
// landmarks of the place looked for from there, covisible keyframes asked whether they see it, too;
// at last, whether tracking can have drifted so far (ORB-SLAM §VII-B; Campos et al. 2021, §VI-A),
// or the camera have gone from one map to the other (DoubtOf(), for keyframes from
// `recording` on, whose times are of one clock; invalid: not asked).
std::optional<LoopMatch> VerifyLoop(const MapSnapshot& map, KeyFrameId keyframe, KeyFrameId place,
                                    const Camera& camera, const LoopSettings& settings,
                                    KeyFrameId recording = {});

}  // namespace alidade
