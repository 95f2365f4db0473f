#include "alidade/evaluation/rpe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/evaluation/matched.h"

namespace alidade {
namespace {

// Index of the partner of pose i; -1: none.
int Partner(const TimeOrder& estimate, int i, const RpeSettings& settings) {
  const int last = static_cast<int>(estimate.stamps.size()) - 1;
  if (settings.unit == DeltaUnit::kFrames) {
    const int step = static_cast<int>(settings.delta);
    return step > last - i ? -1 : i + step;
  }
  const double target = estimate.stamps[i] + settings.delta;
  if (settings.pairs == PairSelection::kConsecutive && target > estimate.stamps.back()) return -1;
  const int j = NearestStamp(estimate.stamps, target);
  return j > i ? j : -1;
}

std::vector<std::pair<int, int>> ChoosePairs(const TimeOrder& estimate,
                                             const RpeSettings& settings) {
  const int last = static_cast<int>(estimate.stamps.size()) - 1;
  std::vector<std::pair<int, int>> pairs;
  if (settings.pairs == PairSelection::kConsecutive) {
    for (int i = 0, j = Partner(estimate, 0, settings); j >= 0;
         i = j, j = Partner(estimate, i, settings)) {
      pairs.push_back({i, j});
    }
    return pairs;
  }
  if (settings.pairs == PairSelection::kEvery) {
    for (int i = 0; i <= last; ++i) {
      for (int j = 0; j <= last; ++j) pairs.push_back({i, j});
    }
    return pairs;
  }
  for (int i = 0; i <= last; ++i) {
    const int j = Partner(estimate, i, settings);
    if (j >= 0 && j != last) pairs.push_back({i, j});
  }
  return pairs;
}

}  // namespace

void RpeSettings::Check() const {
  if (!(max_dt > 0)) ThrowUsage("max-dt must be a positive number of seconds");
  if (!(delta > 0) || !std::isfinite(delta)) ThrowUsage("delta must be positive, like 1s or 30f");
  if (unit == DeltaUnit::kFrames && (delta != std::floor(delta) || delta > 1e9)) {
    ThrowUsage("a delta in frames must be a whole number, like 30f");
  }
}

RpeResult EvaluateRpe(const Trajectory& truth, const Trajectory& estimate,
                      const RpeSettings& settings) {
  settings.Check();
  const TimeOrder truth_order = OrderByTime(truth, "truth");
  const TimeOrder estimate_order = OrderByTime(estimate, "estimate");
  const std::vector<StampPair> matches =
      MatchPoses(truth_order, estimate_order, settings.max_dt, Association::kTum);

  RpeResult result;
  result.coverage = Coverage(truth_order, estimate_order, matches, settings.source_span);
  if (settings.align == Alignment::kSim3) {
    result.scale = AlignTrajectories(truth, estimate, matches, Alignment::kSim3).s;
  }

  // Index of the truth pose nearest in time to estimate pose i; -1 when it is further than max_dt.
  // Two poses may share one.
  const auto nearest_truth = [&](int i) {
    const int t = NearestStamp(truth_order.stamps, estimate_order.stamps[i]);
    const double difference = std::abs(truth_order.stamps[t] - estimate_order.stamps[i]);
    return difference <= settings.max_dt ? truth_order.index[t] : -1;
  };
  const auto chosen = ChoosePairs(estimate_order, settings);
  std::vector<double> metres, degrees;
  for (const auto& [i, j] : chosen) {
    const int truth_i = nearest_truth(i), truth_j = nearest_truth(j);
    if (truth_i < 0 || truth_j < 0) continue;
    const Se3& from = estimate[estimate_order.index[i]].T_world_camera;
    const Se3& to = estimate[estimate_order.index[j]].T_world_camera;
    Se3 moved = from.Inverse() * to;
    moved.t *= result.scale;
    const Se3 truly_moved = truth[truth_i].T_world_camera.Inverse() * truth[truth_j].T_world_camera;
    metres.push_back((moved.Inverse() * truly_moved).t.norm());
    degrees.push_back(RotationAngle(moved, truly_moved) * 180 / std::numbers::pi);
  }
  if (metres.empty()) {
    const double span = estimate_order.stamps.back() - estimate_order.stamps.front();
    ThrowInput("no two matched poses are " + std::to_string(settings.delta) +
               (settings.unit == DeltaUnit::kSeconds ? " s" : " frames") +
               " apart: the estimate has " + std::to_string(estimate.size()) + " poses in " +
               std::to_string(span) + " s; choose a smaller --delta");
  }
  result.trans = DescribeErrors(std::move(metres));
  result.rot = DescribeErrors(std::move(degrees));
  return result;
}

}  // namespace alidade
