// The state of the dynamic filter for one frame.
#pragma once

#include <cstdint>
#include <vector>

namespace alidade {

// Built completely for each frame from that of the previous frame.
struct FrameBelief {
  // Per cell:
  std::vector<float> depth;     // meters, 0 = unknown; empty: no depth in this frame
  std::vector<float> geometry;  // log-odds of being static, without objects
  // Nonzero: covered by an object of a moving class, or by a carried one that moves.
  std::vector<uint8_t> object;
  std::vector<float> resting;   // log-odds of being static of the object there; 0: no object
  std::vector<float> log_odds;  // log-odds of being static, combined
  // Per track: -1 moving, 0 unknown, 1 static.
  std::vector<int8_t> votes;
};

}  // namespace alidade
