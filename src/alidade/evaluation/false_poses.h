// Which poses of a map are plainly wrong, and whether its scale held: a run is judged by the poses
// it should not have given as much as by those it lacks.
#pragma once

#include <vector>

#include "alidade/base/api.h"
#include "alidade/evaluation/ate.h"

namespace ALIDADE_API alidade {

struct FalsePoseSettings {
  double share_of_path = 0.1;  // a pose further from the truth than this share of the path is wrong
  double degrees = 10;         // one that is turned by more is, too
  // Metres: the path, and the scale, are measured in steps of this length of the truth. A hand
  // trembles by 0.03 m from one moment to another, which is no way that was made.
  double step = 0.1;
  double max_dt = 0.02;  // seconds between a pose and its truth
  void Check() const;    // throws Error (usage) naming the field that cannot be
};

struct FalsePoses {
  double path = 0;               // metres the truth goes from the map's first pose to its last
  std::vector<int> wrong;        // indices into the estimate, ascending
  std::vector<StampPair> pairs;  // that were compared
  ErrorStatistics metres, degrees;
  // Truth's lengths over the estimate's in the last third of the map's poses, divided by the same
  // in its first third: 1 when the scale held, 2 when what is 1 m came out half as long at the end
  // as at the beginning. NaN where a third has less than a step of way.
  double scale_drift = 0;
};

// Of one map. The estimate is laid on the truth by the similarity (or motion, as `align` says) that
// fits all its poses best in least squares; the path is that of the truth from the map's first pose
// to its last, in steps, and no less than the largest distance of a pose's truth from that of the
// first. Turns are compared after the rotation that fits the orientations best, not the one that
// fits the positions: these say nothing of a roll about a straight way. Fewer than three matched
// poses: nothing is wrong. Nor is, by its place, a pose of a camera that never moved.
FalsePoses FindFalsePoses(const Trajectory& truth, const Trajectory& estimate, Alignment align,
                          const FalsePoseSettings& settings = {});

}  // namespace alidade
