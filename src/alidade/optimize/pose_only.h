// Pose of one camera from matched landmarks: robust least squares on reprojection errors.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

struct PoseOnlySettings {
  int max_iterations = 10;  // Gauss–Newton steps per round
  int rounds = 4;           // after each, matches beyond the gate are set aside, and may come back
  double huber_mono =
      2.447;  // sqrt(5.991): 95 % of chi² with 2 degrees of freedom, in standard deviations
  double huber_stereo = 2.796;  // sqrt(7.815): with 3
  void Check() const;           // throws Error naming the field that cannot be
};

struct PoseMatch {
  Eigen::Vector3d p_world;  // landmark in the world frame, meters
  // u, v (undistorted), and u in the right image (NaN if there is none), pixels.
  Eigen::Vector3d pixel;
  double inv_sigma2 = 1;        // 1 / variance of u and v, 1/px²
  double inv_sigma2_right = 1;  // 1 / variance of the disparity u - u_right, 1/px²
  double trust = 1;             // 0 to 1, weight in the cost; does not change the gate
};

struct PoseOnlyResult {
  Se3 T_camera_world;
  std::vector<bool> inlier;  // one per match; never true behind the camera
  int inliers = 0;
  double cost = 0;                          // ½ sum of chi² over inliers, unitless
  Matrix6d information = Matrix6d::Zero();  // of the left increment at the solution, inliers only
  // Number of measured coordinates (2 or 3 per match), weighted by trust, inliers only.
  double measured = 0;
  // Covariance of the left increment at the solution (meters, radians): the true T_camera_world is
  // Exp(xi) * T_camera_world with xi ~ N(0, covariance). Equivalently, T_world_camera * Exp(-xi) in
  // the camera frame. See PoseCovariance(). Zero: unknown.
  Matrix6d covariance = Matrix6d::Zero();
};

// Returns information⁻¹ times the estimated variance factor s², so that the covariance reflects the
// measured residuals (errors of the landmarks, which are treated as exact, included) rather than
// the assumed noise. s² = 2 cost / (measured - 6) (Förstner & Wrobel 2016, eq. 4.89), corrected for
// truncation by the gate: for normal errors within the gate `gate` (chi² with 2 degrees of freedom)
// the mean of chi² / 2 is 1 - (g / 2) / (exp(g / 2) - 1) with g = gate / s². Zero if the pose is
// not determined: fewer than 7 coordinates, or a singular information matrix.
Matrix6d PoseCovariance(const Matrix6d& information, double cost, double measured, double gate);

// Starts at `T_camera_world`. Each round minimizes the Huber loss over the current inliers (all
// matches at first), then reclassifies as inliers the matches within `huber` of the result; finally
// minimizes plain squares over the inliers. Fewer than 3 usable matches: returns the start with no
// inliers. Non-finite matches are never inliers. ORB-SLAM2 (Mur-Artal & Tardós 2017), eq. 3–4; left
// increments as in Solà et al. 2018.
PoseOnlyResult OptimizePose(const Camera& camera, const Se3& T_camera_world,
                            std::span<const PoseMatch> matches,
                            const PoseOnlySettings& settings = {});

}  // namespace alidade
