// The truth of a recording, where it is known, and how far a run is from it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/evaluation/ate.h"
#include "alidade/evaluation/rpe.h"
#include "alidade/view/plots.h"

namespace alidade {

// What lies beside a recording as its truth; empty: nothing that can be read.
Trajectory TruthBeside(const std::string& source);

// Its poses from `first` to `last` seconds.
Trajectory Between(const Trajectory& trajectory, double first, double last);

struct TruthErrors {
  AteResult ate;
  std::optional<RpeResult> rpe;  // over one second; none: the run is too short
};

// As `alidade evaluate` with its defaults; with one camera aligned by Sim(3), which has no scale of
// its own, else by SE(3). Nothing, and `problem` says why, when they have too little in common.
std::optional<TruthErrors> ErrorsAgainst(const Trajectory& truth, const Trajectory& estimate,
                                         bool mono, const std::optional<TimeSpan>& span,
                                         std::string* problem);

// Distance to the truth over seconds since `start`.
Curve ErrorCurve(const TruthErrors& errors, const Trajectory& estimate, double start);

// A trajectory as it is drawn, laid by `T`: cut where the time between two poses is ten times what
// it is as a rule, as where tracking was lost.
DrawnPath PathOf(const Trajectory& trajectory, const Sim3& T = {});

}  // namespace alidade
