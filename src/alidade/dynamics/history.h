// Earlier frames that the present one is held against.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "alidade/dynamics/belief_settings.h"
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
  explicit History(const HistorySettings& settings = {}) : settings_(settings) {}

  // Null for a frame without a pose.
  void Add(std::shared_ptr<const PastView> view);
  void Clear();
  // That of `ago` frames before the present one, from 1 on; null when there is none.
  const PastView* Before(int ago) const;
  // Of the earlier ones, settings.step frames apart or more, the last first; null when there is
  // none.
  const PastView* Older(size_t index) const;
  size_t most_older() const { return static_cast<size_t>(settings_.older); }

 private:
  HistorySettings settings_;
  std::deque<std::shared_ptr<const PastView>> recent_, older_;  // newest first
};

}  // namespace alidade
