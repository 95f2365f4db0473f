// How well a motion between two views explains matches, and the motion that explains them best.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Image points at unit focal length, and what a distance of sigma is there: one for x, one for y.
struct RayPairs {
  std::vector<Eigen::Vector3d> a, b;  // z = 1
  Eigen::Vector2d sigma = {1, 1};

  size_t size() const { return a.size(); }
};

struct MotionScore {
  std::vector<float> gain;  // one for each match: chi² bound less its squared error, 0 for outliers
                            // and points behind
  double score = 0;    // their sum
  int consistent = 0;  // matches within the bound (Sampson's distance, 1 degree of freedom)
  int good = 0;        // of these, in front of both cameras or too far to tell
  int placed = 0;      // of the good, those near enough to tell: parallax beyond the noise
};

// Matches against the motion T_b_a, |t| = 1. `widening` multiplies the chi² bound, for motions that
// are only rough.
MotionScore ScoreMotion(const Se3& T_b_a, const RayPairs& rays, double widening = 1);

struct RefinedMotion {
  Se3 T_b_a;
  // Standard deviations left by the noise that was found (not below sigma / 2), radians: of the
  // direction of t in its worst direction, and of the rotation in its worst.
  double direction_sigma = 0, rotation_sigma = 0;
  double noise = 1;  // standard deviation of the errors within the bound, in sigmas
};

// Least squares on Sampson's distances (Hartley & Zisserman 11.4.3) of the matches within the
// bound, over the five degrees of freedom. Gauss-Newton from `T_b_a`; returns the start where it
// does not get better. The bound is wide first, chi² by at most `widest` (9, or 100 from afar), and
// narrows, so that the start need not be good enough to tell all the inliers.
RefinedMotion RefineMotion(const Se3& T_b_a, const RayPairs& rays, double widest = 9);

// The rotation nearest to a matrix (in the Frobenius norm); identity when that is not finite.
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& m);

// Matches that a camera which only turned would explain too (the rotation from a to b that explains
// most, found from `start`): their images agree within the noise of both. Where it is nearly all
// there is no parallax to speak of, whatever a motion made to fit the noise may claim.
std::vector<bool> ExplainedByRotation(const Eigen::Matrix3d& start, const RayPairs& rays);

}  // namespace alidade
