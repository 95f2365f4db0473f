// Past views for comparison with the current frame.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "alidade/dynamics/belief_settings.h"
#include "alidade/geometry/se3.h"

namespace alidade {

// An earlier frame.
struct PastView {
  int number = 0;  // number of the frame
  Se3 T_camera_world;
  std::vector<float> depth;            // of each cell, meters; 0 = unknown; empty: no depth
  std::vector<float> static_log_odds;  // of each cell, as estimated then
};

// Keeps each of the most recent frames, and some older ones at intervals.
class History {
 public:
  explicit History(const HistorySettings& settings = {}) : settings_(settings) {}

  // Null for a frame without a pose.
  void Add(std::shared_ptr<const PastView> view);
  void Clear();
  // The view `ago` frames before the current one, from 1; null when there is none.
  const PastView* Before(int ago) const;
  // Older views, at least settings.step frames apart; index 0 is the newest. Null when there is
  // none.
  const PastView* Older(size_t index) const;
  size_t most_older() const { return static_cast<size_t>(settings_.older); }

 private:
  HistorySettings settings_;
  std::deque<std::shared_ptr<const PastView>> recent_, older_;  // newest first
};

}  // namespace alidade
