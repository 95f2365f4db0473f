#include "alidade/semidense/narrow.h"

#include <algorithm>
#include <cmath>

#include "alidade/semidense/fuse.h"

namespace alidade {

Intervals NarrowSearch(std::span<const Hypothesis> found, const DepthInterval& range, float chi2) {
  std::array<const Hypothesis*, Intervals::kMost> chosen{};
  Intervals intervals;
  while (intervals.count < Intervals::kMost) {
    const Hypothesis* next = nullptr;
    for (const Hypothesis& h : found) {
      if (!h.known() || (next && h.sigma >= next->sigma)) continue;
      const bool differs = std::all_of(chosen.begin(), chosen.begin() + intervals.count,
                                       [&](const auto* c) { return !Compatible(*c, h, chi2); });
      if (differs) next = &h;
    }
    if (!next) break;
    chosen[intervals.count] = next;
    float weight = 0, sum = 0;
    for (const Hypothesis& h : found) {
      if (!h.known() || !Compatible(*next, h, chi2)) continue;
      const float w = 1 / (h.sigma * h.sigma);
      weight += w;
      sum += w * h.inverse_depth;
    }
    const float middle = sum / weight, reach = 3 / std::sqrt(weight);
    intervals.list[intervals.count++] = {std::max(range.min, middle - reach),
                                         std::min(range.max, middle + reach)};
  }
  if (intervals.count == 0) intervals.list[intervals.count++] = range;
  return intervals;
}

}  // namespace alidade
