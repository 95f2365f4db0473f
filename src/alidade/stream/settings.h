// What the stream tells, and how exactly.
#pragma once

#include <span>

namespace alidade {

struct Setting;

// Range, unit and meaning: Table() in settings.cc.
struct StreamSettings {
  // More edges hide the map (ORB-SLAM draws those with at least 100, of 1000 features).
  int edge_shared = 60;
  // 1e-3 are 0.5 pixels at a focal length of 500.
  double landmark_tolerance = 1e-3;
  int depth_points = 8000;
  double outline_tolerance = 3;
  // 20 minutes at 30 per second.
  int path_frames = 36000;
  // People walk 2 m in that time; networks need 0.05 to 0.5 s.
  double detection_seconds = 2;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
