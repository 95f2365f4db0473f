// What the stream tells, and how exactly.
#pragma once

namespace alidade {

struct StreamSettings {
  // Two keyframes are joined by an edge when they share so many landmarks: below, edges are so many
  // that they hide the map (ORB-SLAM draws from 100 on, of 1000 features).
  int edge_shared = 60;
  // A landmark is told again when it has moved against its keyframe by more than this share of its
  // distance: 1e-3 are 0.5 pixels at a focal length of 500.
  double landmark_tolerance = 1e-3;
  // Semi-dense points of a keyframe, at most; of more, every n-th is told.
  int depth_points = 8000;
  // Sides of an outline of what is left out: within this many pixels of the mask's edge.
  double outline_tolerance = 3;
  // Frames of the path that are kept for those who join late. Of more, every other one of the older
  // half is forgotten, again and again.
  int path_frames = 36000;  // 20 minutes at 30 per second
  // An older answer of the detector is not told, seconds: people walk on, 2 m by then. Networks
  // need 0.05 to 0.5 s.
  double detection_seconds = 2;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
