// Depth hypothesis of a pixel.
#pragma once

namespace alidade {

struct Hypothesis {
  float inverse_depth = 0;  // 1/m (mono: 1/map unit), along z
  float sigma = 0;          // standard deviation; 0: unknown

  bool known() const { return sigma > 0; }
};

// Possible range of a pixel's inverse depth; empty if max <= min.
struct DepthInterval {
  float min = 0, max = 0;

  bool empty() const { return max <= min; }
};

}  // namespace alidade
