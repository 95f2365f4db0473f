#include "alidade/semidense/fuse.h"

#include <cmath>

namespace alidade {

Hypothesis Fuse(std::span<const Hypothesis> hypotheses, float chi2, int enough) {
  int most = enough - 1;
  float best_weight = 0;
  Hypothesis fused;
  for (const Hypothesis& centre : hypotheses) {
    if (!centre.known()) continue;
    int count = 0;
    float weight = 0, sum = 0;
    for (const Hypothesis& other : hypotheses) {
      if (!other.known() || !Compatible(centre, other, chi2)) continue;
      const float w = 1 / (other.sigma * other.sigma);
      ++count;
      weight += w;
      sum += w * other.inverse_depth;
    }
    if (count < most || count < enough || (count == most && weight <= best_weight)) continue;
    most = count;
    best_weight = weight;
    fused = {sum / weight, 1 / std::sqrt(weight)};
  }
  return fused;
}

}  // namespace alidade
