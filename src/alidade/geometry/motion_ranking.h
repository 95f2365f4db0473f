// Selection among motion hypotheses between two views, including a test for ambiguity.
#pragma once

#include <vector>

#include "alidade/geometry/relative_pose.h"
#include "alidade/geometry/se3.h"

namespace alidade {

struct RankedMotion {
  Se3 T_b_a;  // |t| = 1
  MotionScore score;
  double direction_sigma = 0;  // of the direction of t, radians
  double noise = 1;            // standard deviation of the residuals, in sigma (see RefinedMotion)
  bool unrefined = false;      // the start of a refinement that ended at another motion
};

// Returns the distinct motions among `motions` whose score comes near the best, each refined,
// sorted by descending score. The planar twin of the best motion (two views of a plane always admit
// two motions) is added as a competitor even if it is not in `motions`.
std::vector<RankedMotion> RankMotions(const std::vector<Se3>& motions, const RayPairs& rays);

// Adds motions found by refinement from 26 directions of t with the rotation of the best motion. At
// small parallax the score has local maxima for several directions, and a model fitted to eight
// matches ends in one of them by chance. A motion with placed < `min_placed_share` * good is
// dropped: the second motion of a plane that puts nearly all points at infinity is not a solution.
// Costs 13 refinements.
std::vector<RankedMotion> AddOtherDirections(std::vector<RankedMotion> ranked, const RayPairs& rays,
                                             double min_placed_share);

// True if the matches do not decide between the two motions: `other` explains more than `max_share`
// of the matches that `best` explains, and its score is not significantly lower.
bool IsRival(const RankedMotion& best, const RankedMotion& other, double max_share);

}  // namespace alidade
