// The similarity, or rigid motion, between two cameras' frames by robust least squares on the
// reprojection errors in both images.
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
  std::vector<bool> inlier;  // one for each match: within the gate in both images
  int inliers = 0;
  double cost = 0;  // ½ sum of chi² over the inliers, unitless
  // At the optimum, of the left increment (t, rotation, log s), inliers only; without scale the
  // last row and column are zero.
  Matrix7d information = Matrix7d::Zero();
};

// Starts at `T_a_b`. Each round minimises Huber's loss over the inliers so far (all at first), then
// counts as inliers what is within `huber` of the result; at the end plain squares over the
// inliers. Fewer than 3 usable matches: returns the start with no inliers. Without scale, s comes
// out as 1. Increments from the left, as in sim3.h.
Sim3RefineResult RefineSim3(const Camera& camera, const Sim3& T_a_b,
                            std::span<const Sim3Match> matches, bool with_scale,
                            const Sim3RefineSettings& settings = {});

}  // namespace alidade
