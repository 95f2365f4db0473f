// Earlier frames that the present one is held against.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// An earlier frame.
struct PastView {
  int number = 0;  // of the frame
  Se3 T_camera_world;
  std::vector<float> depth;            // of each cell, metres; 0 = unknown; empty: none is measured
  std::vector<float> static_log_odds;  // of each cell, as believed then
};

// The last second frame by frame, and some of the seconds before.
class History {
 public:
  // Null for a frame without a pose.
  void Add(std::shared_ptr<const PastView> view);
  void Clear();
  // That of `ago` frames before the present one, from 1 on; null when there is none.
  const PastView* Before(int ago) const;
  // Of the earlier ones, some ten frames apart, the last first; null when there is none.
  const PastView* Older(size_t index) const;

 private:
  std::deque<std::shared_ptr<const PastView>> recent_, older_;  // newest first
};

}  // namespace alidade
