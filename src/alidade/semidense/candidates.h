// Search intervals of a pixel in the next keyframe, from its hypotheses in previous ones.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "alidade/semidense/fuse.h"
#include "alidade/semidense/simd/line_search.h"

namespace alidade {

// Groups the hypotheses of one pixel by compatibility as they are added.
class Candidates {
 public:
  explicit Candidates(float chi2) : chi2_(chi2) {}

  void Add(const Hypothesis& h) {
    if (!h.known()) return;
    ++known_;
    const float w = 1 / (h.sigma * h.sigma);
    for (int i = 0; i < count_; ++i) {
      if (!Compatible(groups_[i].mean, h, chi2_)) continue;
      Group& group = groups_[i];
      group.sum += w * h.inverse_depth;
      group.weight += w;
      group.mean = {group.sum / group.weight, 1 / std::sqrt(group.weight)};
      return;
    }
    if (count_ < kMost) groups_[count_++] = {w * h.inverse_depth, w, h};
  }

  int known() const { return known_; }  // hypotheses added

  // Intervals of ±3 standard deviations around each group; all of `range` if there are none. Valid
  // until the next call.
  std::span<const DepthInterval> Around(const DepthInterval& range) {
    intervals_[0] = range;
    for (int i = 0; i < count_; ++i) {
      const Hypothesis& mean = groups_[i].mean;
      intervals_[i] = {std::max(range.min, mean.inverse_depth - 3 * mean.sigma),
                       std::min(range.max, mean.inverse_depth + 3 * mean.sigma)};
    }
    return {intervals_.data(), static_cast<size_t>(std::max(1, count_))};
  }

 private:
  static constexpr int kMost = kMostIntervals;
  struct Group {
    // Sum of weighted inverse depths; sum of weights (inverse variances).
    float sum = 0, weight = 0;
    Hypothesis mean;
  };
  float chi2_;
  std::array<Group, kMost> groups_;
  std::array<DepthInterval, kMost> intervals_;
  int count_ = 0, known_ = 0;
};

}  // namespace alidade
