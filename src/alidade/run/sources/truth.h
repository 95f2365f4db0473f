// The ground truth of a recording, if it is known, and the errors of a run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/evaluation/ate.h"
#include "alidade/evaluation/rpe.h"
#include "alidade/view/plots.h"

namespace alidade {

// Ground truth of a recording; empty: none that can be read.
Trajectory TruthBeside(const std::string& source);

// Its poses from `first` to `last` seconds.
Trajectory Between(const Trajectory& trajectory, double first, double last);

// How an estimate is aligned to the ground truth before errors are computed, and why.
struct ChosenAlignment {
  Alignment align = Alignment::kSe3;
  std::string why;
};
const char* NameOf(Alignment align);  // "se3", "sim3", "none"

// By the sensor of the run ("mono", "stereo", "rgbd"): Sim(3) for one camera, whose scale is
// unknown, else SE(3); also SE(3) for an unknown sensor (empty).
ChosenAlignment AlignmentFor(const std::string& sensor);
// The same if `word` is auto; else the alignment it names (se3, sim3, none). Throws Error (usage),
// naming `option`, for other words.
ChosenAlignment AlignmentNamed(const std::string& option, const std::string& word,
                               const std::string& sensor);

// "aligned by Sim(3) (one camera), scale 0.512": `scale` multiplies the estimate. With SE(3) also
// the scale that Sim(3) would find, if any.
std::string InWords(const ChosenAlignment& chosen, double scale, const Trajectory& truth,
                    const Trajectory& estimate, double max_dt);

struct TruthErrors {
  AteResult ate;
  std::optional<RpeResult> rpe;  // over one second; nullopt: the run is too short
};

// The same as `alidade evaluate` with its defaults. nullopt, with the reason in `problem`, if both
// have too few common times.
std::optional<TruthErrors> ErrorsAgainst(const Trajectory& truth, const Trajectory& estimate,
                                         bool mono, const std::optional<TimeSpan>& span,
                                         std::string* problem);

// Distance to the ground truth over seconds since `start`.
Curve ErrorCurve(const TruthErrors& errors, const Trajectory& estimate, double start);

// A trajectory for drawing, transformed by `T`, split where the time between two poses is more than
// ten times the usual one, for example where tracking was lost.
DrawnPath PathOf(const Trajectory& trajectory, const Sim3& T = {});

}  // namespace alidade
