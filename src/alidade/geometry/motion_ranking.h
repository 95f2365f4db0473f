// Which of many motions between two views it was, and whether that can be told at all.
#pragma once

#include <vector>

#include "alidade/geometry/relative_pose.h"
#include "alidade/geometry/se3.h"

namespace alidade {

struct RankedMotion {
  Se3 T_b_a;  // |t| = 1
  MotionScore score;
  double direction_sigma = 0;  // of t, radians
  double noise = 1;            // of the errors (RefinedMotion)
  bool unrefined = false;      // a start from which refinement went far away
};

// The distinct motions among `motions` that come near explaining the most, each refined, best
// first. The one a plane could be mistaken for (a plane seen by two cameras always allows two)
// competes with the best, whether or not it was among them.
std::vector<RankedMotion> RankMotions(const std::vector<Se3>& motions, const RayPairs& rays);

// The ranked motions and those that are found when the camera is believed to have gone elsewhere:
// refinement started from 26 directions about it, with the best one's rotation. Where parallax is
// small, what explains matches has valleys of its own about several directions, and models fitted
// to eight matches each end in one of them by chance. What places less than `min_placed_share` of
// what it explains is left out: a plane's second motion that puts nearly all of it far away is no
// answer. Costs 13 refinements.
std::vector<RankedMotion> AddOtherDirections(std::vector<RankedMotion> ranked, const RayPairs& rays,
                                             double min_placed_share);

// Whether the matches leave open which of the two it is: `other` explains more than `max_share` of
// what the best explains, and not clearly worse.
bool IsRival(const RankedMotion& best, const RankedMotion& other, double max_share);

}  // namespace alidade
