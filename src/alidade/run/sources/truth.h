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

// How an estimate is laid on the truth before errors are measured, and why.
struct ChosenAlignment {
  Alignment align = Alignment::kSe3;
  std::string why;
};
const char* NameOf(Alignment align);  // "se3", "sim3", "none"

// By the run's sensor ("mono", "stereo", "rgbd"): Sim(3) with one camera, which has no scale of its
// own, else SE(3); SE(3) as well where the sensor is not known (empty).
ChosenAlignment AlignmentFor(const std::string& sensor);
// The same when `word` is auto; else what it says (se3, sim3, none). Throws Error (usage), naming
// `option`, when it says none of these.
ChosenAlignment AlignmentNamed(const std::string& option, const std::string& word,
                               const std::string& sensor);

// "aligned by Sim(3) (one camera), scale 0.512": `scale` is what the estimate was multiplied by.
// With SE(3) the scale that Sim(3) would find, where it finds one.
std::string InWords(const ChosenAlignment& chosen, double scale, const Trajectory& truth,
                    const Trajectory& estimate, double max_dt);

struct TruthErrors {
  AteResult ate;
  std::optional<RpeResult> rpe;  // over one second; none: the run is too short
};

// As `alidade evaluate` with its defaults. Nothing, and `problem` says why, when they have too
// little in common.
std::optional<TruthErrors> ErrorsAgainst(const Trajectory& truth, const Trajectory& estimate,
                                         bool mono, const std::optional<TimeSpan>& span,
                                         std::string* problem);

// Distance to the truth over seconds since `start`.
Curve ErrorCurve(const TruthErrors& errors, const Trajectory& estimate, double start);

// A trajectory as it is drawn, laid by `T`: cut where the time between two poses is ten times what
// it is as a rule, as where tracking was lost.
DrawnPath PathOf(const Trajectory& trajectory, const Sim3& T = {});

}  // namespace alidade
