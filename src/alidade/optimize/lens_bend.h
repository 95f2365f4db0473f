// How much a lens bends what its camera is taken to see straight: a distortion nobody told of.
#pragma once

#include <optional>

#include "alidade/base/api.h"
#include "alidade/optimize/bundle_adjustment.h"

namespace ALIDADE_API alidade {

struct LensBend {
  // Radial distortion on top of what the observations were undistorted with: ideal image points at
  // distance r from the axis (focal length 1) are seen at r (1 + k1 r²). Unitless.
  double k1 = 0;
  double sigma = 0;  // its standard deviation, from the residuals
};

// One Gauss–Newton step from an adjusted bundle with two parameters more, the focal length and k1;
// all cameras (`fixed` is not looked at), points and the focal length are eliminated. A residual
// alone says little: most of a bend is taken up by poses and points. A focal length that is off
// bends what is seen from a turning camera, too, and is kept apart by being free. Residuals have
// Huber's weight. Nothing where what was seen does not tell a bend from everything else.
std::optional<LensBend> EstimateLensBend(const BundleProblem& problem);

}  // namespace alidade
