#include "alidade/evaluation/ate.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/evaluation/matched.h"
#include "alidade/geometry/alignment.h"

namespace alidade {

void AteSettings::Check() const {
  if (!(max_dt > 0)) ThrowUsage("max-dt must be a positive number of seconds");
}

Sim3 AlignTrajectories(const Trajectory& truth, const Trajectory& estimate,
                       const std::vector<StampPair>& pairs, Alignment align) {
  if (align == Alignment::kNone) return {};
  std::vector<Eigen::Vector3d> target, source;
  for (const StampPair& pair : pairs) {
    target.push_back(truth[pair.truth].T_world_camera.t);
    source.push_back(estimate[pair.estimate].T_world_camera.t);
  }
  return AlignPoints(target, source, align == Alignment::kSim3);
}

AteResult EvaluateAte(const Trajectory& truth, const Trajectory& estimate,
                      const AteSettings& settings) {
  settings.Check();
  const TimeOrder truth_order = OrderByTime(truth, "truth");
  const TimeOrder estimate_order = OrderByTime(estimate, "estimate");
  AteResult result;
  result.pairs = MatchPoses(truth_order, estimate_order, settings.max_dt, settings.association);
  result.coverage = Coverage(truth_order, estimate_order, result.pairs, settings.source_span);
  result.T_truth_estimate = AlignTrajectories(truth, estimate, result.pairs, settings.align);
  for (const StampPair& pair : result.pairs) {
    const Eigen::Vector3d aligned =
        result.T_truth_estimate * estimate[pair.estimate].T_world_camera.t;
    result.distances.push_back((aligned - truth[pair.truth].T_world_camera.t).norm());
  }
  result.error = DescribeErrors(result.distances);
  return result;
}

}  // namespace alidade
