// What is believed of one frame.
#pragma once

#include <cstdint>
#include <vector>

namespace alidade {

// A value: that of each frame is made whole, from the one of the frame before.
struct FrameBelief {
  // Of each cell:
  std::vector<float> depth;     // metres, 0 = unknown; empty: none is measured
  std::vector<float> geometry;  // log-odds of standing still, objects apart
  std::vector<uint8_t> object;  // nonzero = of one that moves by itself
  std::vector<float> resting;   // log-odds of standing still of an object there, 0 = there is none
  std::vector<float> log_odds;  // of standing still, all together
  // Of each track: -1 it moved, 0 unknown, 1 it stood still.
  std::vector<int8_t> votes;
};

}  // namespace alidade
