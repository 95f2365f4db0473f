// Finds grossly wrong poses of a map, and measures the drift of its scale.
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
  double path = 0;         // length of the true path from the map's first to its last pose, meters
  std::vector<int> wrong;  // indices into the estimate, ascending
  std::vector<StampPair> pairs;  // the pairs compared
  ErrorStatistics metres, degrees;
  // Ratio of true to estimated path length in the last third of the map's poses, divided by the
  // same ratio in the first third. 1: no scale drift; 2: 1 m of the truth is estimated half as long
  // at the end as at the beginning. NaN when a third is shorter than one step.
  double scale_drift = 0;
};

// Evaluates one map. Positions are compared after the least-squares alignment of all poses selected
// by `align`. The path length is measured along the truth, in steps, from the map's first to its
// last pose; it is at least the largest distance of a true position from the first one.
// Orientations are compared after the rotation that fits the orientations best, because positions
// on a straight path do not determine the roll about it. No pose is wrong when fewer than three
// match; no position is wrong when the camera did not move. Throws Error (input) when a number is
// not finite.
FalsePoses FindFalsePoses(const Trajectory& truth, const Trajectory& estimate, Alignment align,
                          const FalsePoseSettings& settings = {});

}  // namespace alidade
