// Rotation between two views of a camera that turned on the spot, from matched directions.
#pragma once

#include <Eigen/Core>
#include <span>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct RotationFit {
  Eigen::Matrix3d R_a_b = Eigen::Matrix3d::Identity();
  // Robust standard deviation of a direction along each axis, radians: the noise of the keypoints,
  // and the parallax if the camera moved.
  double residual = 0;
  // Mean of |b|² I - b b' over the inliers: the covariance of R_a_b, with R_a_b Exp(e) the true
  // rotation, is residual² information⁻¹ / inliers where residuals are independent.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  int inliers = 0;  // within 3 standard deviations
};

// `a`, `b`: as many unit vectors, of one match each. Iteratively reweighted least squares from
// `start` with the loss of Geman & McClure 1985, whose scale is the median residual, at least
// `least_residual` (radians); more than half of the matches must be right. Fewer than 3 matches:
// the start without inliers.
RotationFit FitRotation(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b,
                        const Eigen::Matrix3d& start, double least_residual);

}  // namespace alidade
