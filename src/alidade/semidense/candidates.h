// Where the next keyframe is to be searched, by what the ones before it gave.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "alidade/semidense/fuse.h"

namespace alidade {

// Hypotheses of one pixel as they come, in groups that agree.
class Candidates {
 public:
  explicit Candidates(float chi2) : chi2_(chi2) {}

  void Add(const Hypothesis& h) {
    if (!h.known()) return;
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

  // Three standard deviations to both sides of each group; without any, all of `range`. Holds until
  // the next call.
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
  static constexpr int kMost = 3;
  struct Group {
    float sum = 0, weight = 0;  // of inverse depths by inverse variance
    Hypothesis mean;
  };
  float chi2_;
  std::array<Group, kMost> groups_;
  std::array<DepthInterval, kMost> intervals_;
  int count_ = 0;
};

}  // namespace alidade
