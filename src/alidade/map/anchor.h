// A camera pose relative to a keyframe. It stays valid when corrections move or scale the keyframe.
#pragma once

#include "alidade/map/map_store.h"

namespace alidade {

struct Anchor {
  KeyFrameId keyframe;    // invalid: T_camera_keyframe is T_camera_world
  Se3 T_camera_keyframe;  // at the time of anchoring
  double scale = 1;       // KeyFrame::scale at the time of anchoring
};

inline Anchor AnchorTo(const MapState& map, KeyFrameId keyframe, const Se3& T_camera_world) {
  return {keyframe, T_camera_world * map.PoseOf(keyframe).Inverse(), map.ScaleOf(keyframe)};
}

// Current T_camera_world.
inline Se3 PoseOf(const MapState& map, const Anchor& anchor) {
  if (!anchor.keyframe.valid()) return anchor.T_camera_keyframe;
  Se3 T_camera_keyframe = anchor.T_camera_keyframe;
  T_camera_keyframe.t *= map.ScaleOf(anchor.keyframe) / anchor.scale;
  return T_camera_keyframe * map.PoseOf(anchor.keyframe);
}

// Re-expresses an anchor relative to the nearest live ancestor of a culled keyframe; an anchor to a
// live keyframe is returned unchanged. Returns an anchor without a keyframe if the map was dropped.
//   T_camera_parent = T_camera_keyframe · T_keyframe_parent, translations scaled by s_keyframe and
// s_parent. Stored for a parent of scale 1, so that it does not depend on the current scale.
inline Anchor Reanchored(const MapState& map, Anchor anchor) {
  const CulledKeyFrame* gone = map.culled.At(anchor.keyframe.value);
  if (gone) {
    anchor.T_camera_keyframe.t /= anchor.scale;
    anchor.scale = 1;
  }
  while (gone) {
    anchor.T_camera_keyframe.t *= gone->scale;
    anchor.T_camera_keyframe = anchor.T_camera_keyframe * gone->T_camera_parent;
    anchor.keyframe = gone->parent;
    gone = map.culled.At(anchor.keyframe.value);
  }
  return map.keyframes.At(anchor.keyframe.value) ? anchor : Anchor{};
}

}  // namespace alidade
