// Where the next keyframe is to be searched, by what the ones before it gave.
#pragma once

#include <array>
#include <span>

#include "alidade/semidense/hypothesis.h"

namespace alidade {

struct Intervals {
  static constexpr int kMost = 3;
  std::array<DepthInterval, kMost> list;
  int count = 0;
  std::span<const DepthInterval> span() const { return {list.data(), static_cast<size_t>(count)}; }
};

// Around each of the hypotheses that differ, the most certain first, three standard deviations to
// both sides. `chi2`: of those that do not differ. Without any: all of `range`.
Intervals NarrowSearch(std::span<const Hypothesis> found, const DepthInterval& range, float chi2);

}  // namespace alidade
