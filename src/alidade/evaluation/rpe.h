// Relative pose error: how much the motion over a fixed step differs from the true one, i.e. the
// drift. Sturm et al. 2012, eq. 1-3.
#pragma once

#include "alidade/base/api.h"
#include "alidade/evaluation/ate.h"

namespace ALIDADE_API alidade {

enum class DeltaUnit { kSeconds, kFrames };
enum class PairSelection {
  kAll,          // a pair from each pose of the estimate, as TUM's tool with a fixed delta
  kConsecutive,  // a pair begins where the last one ended: no overlap, independent errors
  kEvery,        // each pose with each, forth and back, itself included, whatever lies between:
                 // what TUM's tool draws 10000 from when it is given no fixed delta
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
  ErrorStatistics trans;  // metres
  ErrorStatistics rot;    // degrees
  double scale = 1;       // applied to the estimate
  double coverage = 0;    // as in AteResult
};

// The partner of a pose is the one whose stamp is nearest to the first's plus delta. With kAll a
// pair never ends at the last pose, which stands for "past the end" (TUM's tool does the same, and
// its numbers are the standard). Throws Error (input) like EvaluateAte, and when no pair is left.
RpeResult EvaluateRpe(const Trajectory& truth, const Trajectory& estimate,
                      const RpeSettings& settings = {});

}  // namespace alidade
