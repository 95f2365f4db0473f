// Similarity or rigid motion between two camera frames: robust least squares on the reprojection
// errors in both images.
#pragma once

#include <span>
#include <vector>

#include "alidade/geometry/sim3.h"
#include "alidade/geometry/sim3_ransac.h"

namespace alidade {

struct Sim3RefineSettings {
  int max_iterations = 10;  // Levenberg–Marquardt steps per round
  int rounds = 3;           // after each, matches beyond the gate are set aside, and may come back
  // sqrt(9.21): 99 % of chi² with 2 degrees of freedom, in standard deviations; of each image.
  // Wider than a pose's: the points are not landmarks agreed upon, but as each map has them.
  double huber = 3.035;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

struct Sim3RefineResult {
  Sim3 T_a_b;
  std::vector<bool> inlier;  // one per match: within the gate in both images
  int inliers = 0;
  double cost = 0;  // ½ sum of chi² over the inliers, unitless
  // Of the left increment (t, rotation, log s) at the optimum, inliers only; without scale the last
  // row and column are zero.
  Matrix7d information = Matrix7d::Zero();
};

// Starts at `T_a_b`. Each round minimizes the Huber loss over the current inliers (all matches at
// first), then reclassifies as inliers the matches within `huber` of the result; finally minimizes
// plain squares over the inliers. Fewer than 3 usable matches: returns the start with no inliers.
// Without scale, s is 1. Left increments as in sim3.h.
Sim3RefineResult RefineSim3(const Camera& camera, const Sim3& T_a_b,
                            std::span<const Sim3Match> matches, bool with_scale,
                            const Sim3RefineSettings& settings = {});

}  // namespace alidade
