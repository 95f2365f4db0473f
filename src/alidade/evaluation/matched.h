// Shared by both error measures: checks poses, sorts them by time and matches them to the ground
// truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/evaluation/ate.h"

namespace ALIDADE_API alidade {

struct TimeOrder {
  std::vector<double> stamps;  // ascending, seconds
  std::vector<int> index;      // of each stamp in the original trajectory
};

// Throws Error (input) when a number is not finite; `name` appears in the message.
TimeOrder OrderByTime(const Trajectory& trajectory, const std::string& name);

// Indices refer to the trajectories. Throws Error (input) with the reason when there are fewer than
// 3 pairs.
std::vector<StampPair> MatchPoses(const TimeOrder& truth, const TimeOrder& estimate, double max_dt,
                                  Association association);

// Matched truth poses / truth poses within the span (default: the estimate's), at most 1, because a
// match slightly outside the span counts.
double Coverage(const TimeOrder& truth, const TimeOrder& estimate,
                const std::vector<StampPair>& pairs, const std::optional<TimeSpan>& span);

}  // namespace alidade
