// Absolute trajectory error: aligns the estimate to the ground truth and measures the distance at
// each matched pose. Sturm et al. 2012, section III-B; alignment by Umeyama 1991.
#pragma once

#include <optional>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/evaluation/association.h"
#include "alidade/evaluation/statistics.h"
#include "alidade/io/trajectory.h"

namespace ALIDADE_API alidade {

enum class Alignment { kNone, kSe3, kSim3 };

struct TimeSpan {
  double first = 0, last = 0;  // seconds, both included
};

struct AteSettings {
  Alignment align = Alignment::kSe3;  // Sim(3) where the estimate's scale is unknown (one camera)
  double max_dt = 0.02;               // seconds between matched stamps: TUM's default
  Association association = Association::kTum;
  // First and last frame of the recording; coverage is judged over it. Unknown: the estimate's own
  // span.
  std::optional<TimeSpan> source_span = std::nullopt;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

struct AteResult {
  ErrorStatistics error;  // meters
  // Matched truth poses / truth poses within the source's time span, at most 1.
  double coverage = 0;
  Sim3 T_truth_estimate;          // the alignment; scale 1 unless Alignment::kSim3
  std::vector<StampPair> pairs;   // indices into the trajectories passed in
  std::vector<double> distances;  // meters, one per pair
};

// The trajectories may be in any order. Throws Error (input) when a number is not finite, when
// fewer than 3 poses match, or (when aligning) when all poses are at one point.
AteResult EvaluateAte(const Trajectory& truth, const Trajectory& estimate,
                      const AteSettings& settings = {});

// The alignment alone, from matched poses (indices into the trajectories).
Sim3 AlignTrajectories(const Trajectory& truth, const Trajectory& estimate,
                       const std::vector<StampPair>& pairs, Alignment align);

}  // namespace alidade
