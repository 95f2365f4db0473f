#include "alidade/run/sources/truth.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/choice.h"
#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/io/frame_source.h"

namespace alidade {
namespace {

// Time between two poses, in seconds, from which no line is drawn between them.
double GapOf(const std::vector<double>& times) {
  constexpr double kGap = 10;  // times the median interval: a few skipped frames are no gap
  std::vector<double> steps;
  for (size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return kGap * std::abs(*middle);
}

// A clock that is set back is a gap as well.
bool GoesOn(double before, double now, double gap) { return now >= before && now - before <= gap; }

}  // namespace

Trajectory TruthBeside(const std::string& source) {
  if (!IsFolder(source)) return {};
  try {
    return ReadTrajectory(source);
  } catch (const Error&) {
    return {};
  }
}

Trajectory Between(const Trajectory& trajectory, double first, double last) {
  Trajectory within;
  for (const StampedPose& pose : trajectory) {
    if (pose.time >= first && pose.time <= last) within.push_back(pose);
  }
  return within;
}

const char* NameOf(Alignment align) {
  return align == Alignment::kSim3 ? "sim3" : align == Alignment::kSe3 ? "se3" : "none";
}

ChosenAlignment AlignmentFor(const std::string& sensor) {
  if (sensor == NameOf(Sensor::kMono)) return {Alignment::kSim3, "one camera"};
  if (sensor == NameOf(Sensor::kStereo) || sensor == NameOf(Sensor::kRgbd))
    return {Alignment::kSe3, "depth or stereo"};
  return {Alignment::kSe3, "unknown sensor; sim3 is for one camera"};
}

ChosenAlignment AlignmentNamed(const std::string& option, const std::string& word,
                               const std::string& sensor) {
  using Maybe = std::optional<Alignment>;
  const auto align = Choice<Maybe>(option, word,
                                   {{"auto", std::nullopt},
                                    {"se3", Alignment::kSe3},
                                    {"sim3", Alignment::kSim3},
                                    {"none", Alignment::kNone}});
  return align ? ChosenAlignment{*align, option} : AlignmentFor(sensor);
}

std::string InWords(const ChosenAlignment& chosen, double scale, const Trajectory& truth,
                    const Trajectory& estimate, double max_dt) {
  if (chosen.align == Alignment::kNone) return "not aligned";
  const auto in_digits = [](double value) {
    char digits[32];
    PrintTo(digits, sizeof(digits), "%.6f", value);
    return std::string(digits);
  };
  if (chosen.align == Alignment::kSim3)
    return "aligned by Sim(3) (" + chosen.why + "), scale " + in_digits(scale);
  const std::string words = "aligned by SE(3) (" + chosen.why + ")";
  AteSettings similarity;
  similarity.align = Alignment::kSim3;
  similarity.max_dt = max_dt;
  try {
    return words + "; Sim(3) would scale by " +
           in_digits(EvaluateAte(truth, estimate, similarity).T_truth_estimate.s);
  } catch (const Error&) {  // poses without a common scale
    return words;
  }
}

std::optional<TruthErrors> ErrorsAgainst(const Trajectory& truth, const Trajectory& estimate,
                                         bool mono, const std::optional<TimeSpan>& span,
                                         std::string* problem) {
  TruthErrors errors;
  AteSettings ate;
  RpeSettings rpe;
  ate.align = rpe.align = AlignmentFor(NameOf(mono ? Sensor::kMono : Sensor::kRgbd)).align;
  ate.source_span = rpe.source_span = span;
  try {
    errors.ate = EvaluateAte(truth, estimate, ate);
  } catch (const Error& error) {
    *problem = error.what();
    return std::nullopt;
  }
  try {
    errors.rpe = EvaluateRpe(truth, estimate, rpe);
  } catch (const Error&) {  // no two poses are a second apart
  }
  return errors;
}

Curve ErrorCurve(const TruthErrors& errors, const Trajectory& estimate, double start) {
  std::vector<double> times;
  for (const StampPair& pair : errors.ate.pairs)
    times.push_back(estimate[static_cast<size_t>(pair.estimate)].time);
  const double gap = GapOf(times);
  Curve curve;
  for (size_t i = 0; i < times.size(); ++i) {
    if (i == 0 || !GoesOn(times[i - 1], times[i], gap)) curve.emplace_back();
    curve.back().emplace_back(times[i] - start, errors.ate.distances[i]);
  }
  return curve;
}

DrawnPath PathOf(const Trajectory& trajectory, const Sim3& T) {
  std::vector<double> times;
  for (const StampedPose& pose : trajectory) times.push_back(pose.time);
  const double gap = GapOf(times);
  DrawnPath path;
  for (size_t i = 0; i < times.size(); ++i) {
    if (i == 0 || !GoesOn(times[i - 1], times[i], gap)) path.emplace_back();
    const Se3& pose = trajectory[i].T_world_camera;
    path.back().push_back({T.R * pose.R, T * pose.t});
  }
  return path;
}

}  // namespace alidade
