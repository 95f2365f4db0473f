#include "alidade/inertial/largest_sigma.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace alidade {

double LargestSigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

}  // namespace alidade
