#include "alidade/semidense/fuse.h"

#include <array>
#include <cmath>

namespace alidade {
namespace {

float WeightOf(const Hypothesis& h) { return 1 / (h.sigma * h.sigma); }

}  // namespace

Hypothesis Fuse(std::span<const Hypothesis> hypotheses, float chi2, int enough) {
  constexpr size_t kKept = 16;  // weights calculated once
  std::array<float, kKept> weights;
  int known = 0;
  for (size_t k = 0; k < hypotheses.size(); ++k) {
    known += hypotheses[k].known();
    if (k < kKept && hypotheses[k].known()) weights[k] = WeightOf(hypotheses[k]);
  }
  if (known < enough) return {};
  int most = enough - 1;
  float best_weight = 0;
  Hypothesis fused;
  for (const Hypothesis& centre : hypotheses) {
    if (!centre.known()) continue;
    int count = 0;
    float weight = 0, sum = 0;
    for (size_t k = 0; k < hypotheses.size(); ++k) {
      const Hypothesis& other = hypotheses[k];
      if (!other.known() || !Compatible(centre, other, chi2)) continue;
      const float w = k < kKept ? weights[k] : WeightOf(other);
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
