#include "alidade/run/truth.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"

namespace alidade {
namespace {

// Seconds between two of `times` from which on nothing is drawn between them.
double GapOf(const std::vector<double>& times) {
  constexpr double kGap = 10;  // times the median interval: a few frames skipped are no gap
  std::vector<double> steps;
  for (size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return kGap * std::abs(*middle);
}

// Clocks set back are gaps too.
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

std::optional<TruthErrors> ErrorsAgainst(const Trajectory& truth, const Trajectory& estimate,
                                         bool mono, const std::optional<TimeSpan>& span,
                                         std::string* problem) {
  TruthErrors errors;
  AteSettings ate;
  RpeSettings rpe;
  ate.align = rpe.align = mono ? Alignment::kSim3 : Alignment::kSe3;
  ate.source_span = rpe.source_span = span;
  try {
    errors.ate = EvaluateAte(truth, estimate, ate);
  } catch (const Error& error) {
    *problem = error.what();
    return std::nullopt;
  }
  try {
    errors.rpe = EvaluateRpe(truth, estimate, rpe);
  } catch (const Error&) {  // no two poses a second apart
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
