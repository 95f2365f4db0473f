// A place told by a keyframe: follows it through every correction, of place and of scale.
#pragma once

#include "alidade/map/map_store.h"

namespace alidade {

struct Anchor {
  KeyFrameId keyframe;    // none: T_camera_keyframe is T_camera_world
  Se3 T_camera_keyframe;  // as it was then …
  double scale = 1;       // … when the keyframe had this scale
};

inline Anchor AnchorTo(const MapState& map, KeyFrameId keyframe, const Se3& T_camera_world) {
  return {keyframe, T_camera_world * map.PoseOf(keyframe).Inverse(), map.ScaleOf(keyframe)};
}

// T_camera_world now.
inline Se3 PoseOf(const MapState& map, const Anchor& anchor) {
  if (!anchor.keyframe.valid()) return anchor.T_camera_keyframe;
  Se3 T_camera_keyframe = anchor.T_camera_keyframe;
  T_camera_keyframe.t *= map.ScaleOf(anchor.keyframe) / anchor.scale;
  return T_camera_keyframe * map.PoseOf(anchor.keyframe);
}

}  // namespace alidade
