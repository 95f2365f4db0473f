// Pure rotation seen through an uncertain lens. A wrong focal length or radial distortion makes a
// pure rotation look like a translation.
#pragma once

#include <vector>

#include "alidade/geometry/relative_pose.h"

namespace alidade {

// Deviation of the true lens from the assumed one. A ray (x, y, 1) of the assumed lens is in truth
//   u(x, y) = (x, y) (1 + k (x² + y²)) / g.
struct LensChange {
  double g = 1;  // true focal length / assumed focal length
  double k = 0;  // radial coefficient, at unit focal length
};

// One per match: true if a pure rotation explains it together with some lens near the assumed one.
// Estimates rotation, g and k from `R` by Levenberg-Marquardt on g π(R u(a)) - u(b); the gates
// narrow to the noise of both images (2 × the 95 % quantile of chi² with 2 degrees of freedom). The
// first gate admits all matches, so the share of outliers must be small. `uncertainty` limits g to
// [1 / (1 + uncertainty), 1 + uncertainty] and k to ±uncertainty / 2. `found` (may be null)
// receives the estimated lens.
std::vector<bool> ExplainedByTurnedLens(const Eigen::Matrix3d& R, const RayPairs& rays,
                                        double uncertainty, LensChange* found = nullptr);

}  // namespace alidade
