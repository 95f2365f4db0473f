// Relative pose error: the difference of estimated and true motion over a fixed step, which
// measures drift. Sturm et al. 2012, eq. 1-3.
#pragma once

#include "alidade/base/api.h"
#include "alidade/evaluation/ate.h"

namespace ALIDADE_API alidade {

enum class DeltaUnit { kSeconds, kFrames };
enum class PairSelection {
  kAll,          // a pair starts at each pose of the estimate, as in TUM's tool with a fixed delta
  kConsecutive,  // a pair starts where the previous one ended: no overlap, independent errors
  // All ordered pairs of poses, including each pose with itself: the set from which TUM's tool
  // draws 10000 pairs when no fixed delta is set.
  kEvery,
};

struct RpeSettings {
  double delta = 1;  // the step: seconds, or poses of the estimate
  DeltaUnit unit = DeltaUnit::kSeconds;
  PairSelection pairs = PairSelection::kAll;
  Alignment align = Alignment::kSe3;  // only Sim(3) matters: its scale is applied to the estimate
  double max_dt = 0.02;               // seconds between a pose and the truth's nearest
  std::optional<TimeSpan> source_span = std::nullopt;  // as in AteSettings
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

struct RpeResult {
  ErrorStatistics trans;  // meters
  ErrorStatistics rot;    // degrees
  double scale = 1;       // scale applied to the estimate
  double coverage = 0;    // as in AteResult
};

// The partner of a pose is the pose whose stamp is nearest to the first stamp plus delta. With kAll
// no pair ends at the last pose, which stands for "past the end" as in TUM's tool. Throws Error
// (input) as EvaluateAte(), and when no pair remains.
RpeResult EvaluateRpe(const Trajectory& truth, const Trajectory& estimate,
                      const RpeSettings& settings = {});

}  // namespace alidade
