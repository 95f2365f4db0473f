// Scores and refines the relative motion between two views.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Corresponding points of two views at unit focal length.
struct RayPairs {
  std::vector<Eigen::Vector3d> a, b;  // z = 1
  // Standard deviation of a point in x and y, at unit focal length.
  Eigen::Vector2d sigma = {1, 1};

  size_t size() const { return a.size(); }
};

struct MotionScore {
  // One per match: chi² bound minus squared error; 0 for outliers and points behind a camera.
  std::vector<float> gain;
  double score = 0;    // sum of `gain`
  int consistent = 0;  // matches within the chi² bound (Sampson distance, 1 degree of freedom)
  int good = 0;        // consistent matches in front of both cameras, or too far to decide
  int placed = 0;      // good matches whose parallax exceeds the noise
};

// Scores the matches against T_b_a, |t| = 1. `widening` multiplies the chi² bound, for motions that
// are only approximate.
MotionScore ScoreMotion(const Se3& T_b_a, const RayPairs& rays, double widening = 1);

struct RefinedMotion {
  Se3 T_b_a;
  // Standard deviations, radians, along the worst direction of the direction of t and of the
  // rotation; from the measured noise (at least 0.5 sigma).
  double direction_sigma = 0, rotation_sigma = 0;
  double noise = 1;  // standard deviation of the residuals within the bound, in sigma
};

// Least squares on the Sampson distances (Hartley & Zisserman 11.4.3) of the matches within the
// chi² bound, over the 5 degrees of freedom; Gauss-Newton from `T_b_a`. Returns the start if it
// cannot be improved. The bound starts at `widest` times chi² (9; 100 for a distant start) and
// narrows, so that the start need not identify all inliers.
RefinedMotion RefineMotion(const Se3& T_b_a, const RayPairs& rays, double widest = 9);

// The rotation nearest to `m` in the Frobenius norm; identity if `m` is not finite.
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& m);

// One per match: true if a pure rotation explains it within the noise of both images. The rotation
// is the one that explains most matches, found from `start`. If nearly all matches are explained,
// there is no usable parallax.
std::vector<bool> ExplainedByRotation(const Eigen::Matrix3d& start, const RayPairs& rays);

}  // namespace alidade
