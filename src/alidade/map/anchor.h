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

// The same place told by the living keyframe that a culled one follows; a living one's stays as it
// is. With no keyframe when there is none: its map was dropped.
//   T_camera_parent = T_camera_keyframe(lengths × s_keyframe) · T_keyframe_parent(lengths ×
//   s_parent),
// kept as of a parent of scale 1, so that no scale of the day enters it.
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
