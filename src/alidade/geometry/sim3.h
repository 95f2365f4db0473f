// Exponential, logarithm and Jacobians of similarities. Tangent vectors are (translation ν;
// rotation ω; log scale σ) for the matrix [[ω]x + σ I, ν; 0, 0]; increments act from the left: T <-
// Exp(xi) * T (Strasdat 2012, §2.4.4; Eade 2013, §6).
#pragma once

#include <Eigen/Core>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

Sim3 ExpSim3(const Vector7d& xi);
Vector7d LogSim3(const Sim3& T);  // rotation angle in [0, π]; requires s > 0

// Ad: T * Exp(xi) = Exp(Ad * xi) * T.
Matrix7d AdjointSim3(const Sim3& T);

// Left Jacobian J: Exp(xi + d) = Exp(J * d) * Exp(xi) to first order in d. Its inverse is the
// derivative of the logarithm: Log(Exp(d) * Exp(xi)) = xi + J⁻¹ * d. Valid for rotations below 2π.
Matrix7d LeftJacobianSim3(const Vector7d& xi);
Matrix7d LeftJacobianInverseSim3(const Vector7d& xi);

}  // namespace alidade
