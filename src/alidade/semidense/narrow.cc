#include "alidade/semidense/narrow.h"

#include <algorithm>

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
    const float reach = 3 * next->sigma;
    intervals.list[intervals.count++] = {std::max(range.min, next->inverse_depth - reach),
                                         std::min(range.max, next->inverse_depth + reach)};
  }
  if (intervals.count == 0) intervals.list[intervals.count++] = range;
  return intervals;
}

}  // namespace alidade
