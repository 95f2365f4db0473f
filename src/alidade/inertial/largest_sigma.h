// The standard deviation of a vector along its least known direction.
#pragma once

#include <Eigen/Core>

namespace alidade {

// Root of the largest eigenvalue of a covariance. One of fewer dimensions is filled up with zeros.
double LargestSigma(const Eigen::Matrix3d& covariance);

}  // namespace alidade
