// What a camera that only turned would show, when its lens is not known well: a wrong focal length
// or a lens that bends lines makes a turn on the spot look like a walk past points.
#pragma once

#include <vector>

#include "alidade/geometry/relative_pose.h"

namespace alidade {

// A lens as it may be beside the one assumed: rays as assumed are (x, y, 1); the true ones
//   u(x, y) = (x, y) (1 + k (x² + y²)) / g.
struct LensChange {
  double g = 1;  // true focal length by the assumed one
  double k = 0;  // radial term, at unit focal length
};

// Matches that a camera which only turned explains too with some lens near the assumed one:
// rotation, g and k by least squares (Levenberg-Marquardt on g pi(R u(a)) - u(b), with gates that
// narrow to the noise of both images: 2 x 95 % of chi² with 2 degrees of freedom), from `R` on. All
// of the matches have a say at first, so that few of them may be wrong. `uncertainty`: g stays in
// [1 / (1 + uncertainty), 1 + uncertainty]; k in ±uncertainty / 2. `found`: the lens it took, when
// not null.
std::vector<bool> ExplainedByTurnedLens(const Eigen::Matrix3d& R, const RayPairs& rays,
                                        double uncertainty, LensChange* found = nullptr);

}  // namespace alidade
