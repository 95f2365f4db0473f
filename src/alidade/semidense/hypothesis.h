// What is known of one pixel's depth.
#pragma once

namespace alidade {

struct Hypothesis {
  float inverse_depth = 0;  // 1/m (mono: 1/map unit), along z
  float sigma = 0;          // standard deviation; 0: nothing is known

  bool known() const { return sigma > 0; }
};

// Where the inverse depth of a pixel may lie; empty when max <= min.
struct DepthInterval {
  float min = 0, max = 0;

  bool empty() const { return max <= min; }
};

}  // namespace alidade
