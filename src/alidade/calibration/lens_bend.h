// Estimates radial distortion that the camera model does not include.
#pragma once

#include <optional>

#include "alidade/base/api.h"
#include "alidade/optimize/bundle_adjustment.h"

namespace ALIDADE_API alidade {

struct LensBend {
  // Radial distortion in addition to that of the camera model: ideal image points at distance r
  // from the axis (focal length 1) are observed at r (1 + k1 r²). Unitless.
  double k1 = 0;
  double sigma = 0;  // standard deviation of k1, from the residuals
};

// One Gauss–Newton step from an adjusted bundle with two more parameters, log focal length and k1.
// All cameras (`fixed` is ignored), points and the focal length are eliminated. The residuals
// themselves reveal little, because poses and points absorb most of the distortion. A wrong focal
// length also causes apparent distortion in a rotating camera; as a free parameter it is separated
// from k1. Residuals have Huber weights. Returns nullopt if k1 is not observable.
std::optional<LensBend> EstimateLensBend(const BundleProblem& problem);

}  // namespace alidade
