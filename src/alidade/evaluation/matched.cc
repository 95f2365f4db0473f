#include "alidade/evaluation/matched.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "alidade/base/error.h"
#include "alidade/base/print.h"

namespace alidade {
namespace {

std::string Seconds(double time) {
  char text[64];
  PrintTo(text, sizeof(text), "%.6f", time);
  return text;
}

std::string Span(const TimeOrder& order) {
  return Seconds(order.stamps.front()) + " to " + Seconds(order.stamps.back()) + " s";
}

}  // namespace

TimeOrder OrderByTime(const Trajectory& trajectory, const std::string& name) {
  if (trajectory.empty()) ThrowInput("the " + name + " has no poses");
  for (size_t i = 0; i < trajectory.size(); ++i) {
    const StampedPose& pose = trajectory[i];
    if (!std::isfinite(pose.time) || !pose.T_world_camera.t.allFinite() ||
        !pose.T_world_camera.R.allFinite()) {
      ThrowInput("pose " + std::to_string(i + 1) + " of the " + name +
                 " is not finite (NaN or infinity): remove it");
    }
  }
  TimeOrder order;
  order.index.resize(trajectory.size());
  std::iota(order.index.begin(), order.index.end(), 0);
  std::stable_sort(order.index.begin(), order.index.end(),
                   [&](int a, int b) { return trajectory[a].time < trajectory[b].time; });
  for (const int i : order.index) order.stamps.push_back(trajectory[i].time);
  return order;
}

std::vector<StampPair> MatchPoses(const TimeOrder& truth, const TimeOrder& estimate, double max_dt,
                                  Association association) {
  std::vector<StampPair> pairs =
      AssociateStamps(truth.stamps, estimate.stamps, max_dt, association);
  if (pairs.size() < 3) {
    ThrowInput("only " + std::to_string(pairs.size()) + " of " +
               std::to_string(estimate.stamps.size()) +
               " estimated poses have a true pose within " + Seconds(max_dt) +
               " s (3 are needed): the estimate runs from " + Span(estimate) +
               ", the ground truth from " + Span(truth));
  }
  for (StampPair& pair : pairs) {
    pair = {truth.index[pair.truth], estimate.index[pair.estimate]};
  }
  return pairs;
}

double Coverage(const TimeOrder& truth, const TimeOrder& estimate,
                const std::vector<StampPair>& pairs, const std::optional<TimeSpan>& span) {
  const double first = span ? span->first : estimate.stamps.front();
  const double last = span ? span->last : estimate.stamps.back();
  const auto within = std::upper_bound(truth.stamps.begin(), truth.stamps.end(), last) -
                      std::lower_bound(truth.stamps.begin(), truth.stamps.end(), first);
  std::set<int> matched;  // kEvo may match one true pose twice
  for (const StampPair& pair : pairs) matched.insert(pair.truth);
  if (within <= 0) return 0;
  return std::min(1.0, static_cast<double>(matched.size()) / static_cast<double>(within));
}

}  // namespace alidade
