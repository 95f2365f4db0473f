// What both error measures need first: poses in order of time, checked, and matched to the truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/evaluation/ate.h"

namespace ALIDADE_API alidade {

struct TimeOrder {
  std::vector<double> stamps;  // ascending, seconds
  std::vector<int> index;      // of each in the trajectory it came from
};

// Throws Error (input) when a number of the trajectory (`name` in the message) is not finite.
TimeOrder OrderByTime(const Trajectory& trajectory, const std::string& name);

// Indices are those of the trajectories. Throws Error (input) on fewer than 3 pairs, saying why.
std::vector<StampPair> MatchPoses(const TimeOrder& truth, const TimeOrder& estimate, double max_dt,
                                  Association association);

// Matched poses of the truth / its poses within the span (default: the estimate's), at most 1: a
// match just outside the span counts too.
double Coverage(const TimeOrder& truth, const TimeOrder& estimate,
                const std::vector<StampPair>& pairs, const std::optional<TimeSpan>& span);

}  // namespace alidade
