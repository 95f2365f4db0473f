// Whether covariances of poses are as large as their errors.
#pragma once

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// T_world_camera * Exp(xi) is the true pose, xi = (translation; rotation) ~ N(0, covariance).
struct UncertainPose {
  Se3 T_world_camera;
  Matrix6d covariance = Matrix6d::Zero();
};

// Squared error of the motion from `a` to `b` in standard deviations: chi² with 6 degrees of
// freedom where the covariances are right and the errors of the two poses independent. An error
// that both poses share cancels. `T_a_b_true` is in the unit of the poses.
double MotionChiSquared(const UncertainPose& a, const UncertainPose& b, const Se3& T_a_b_true);

}  // namespace alidade
