// Pose of one camera from matched landmarks, by robust least squares on reprojection errors.
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
  Eigen::Vector3d p_world;  // landmark, metres
  Eigen::Vector3d
      pixel;  // u, v (undistorted) and u in the right image (NaN when there is none), pixels
  double inv_sigma2 = 1;        // 1 / variance of u and v, 1/px²
  double inv_sigma2_right = 1;  // the same of the disparity u - u_right, 1/px²
  double trust = 1;             // 0…1: its say in the pose; the gate does not change with it
};

struct PoseOnlyResult {
  Se3 T_camera_world;
  std::vector<bool> inlier;  // one for each match; behind the camera is never one
  int inliers = 0;
  double cost = 0;                          // ½ sum of chi² over inliers, unitless
  Matrix6d information = Matrix6d::Zero();  // of the left increment at the solution, inliers only
  double measured =
      0;  // numbers measured (2 or 3 a match), each counted by its trust, inliers only
  // Of the left increment at the solution (metres, radians): the true T_camera_world is Exp(xi) *
  // T_camera_world with xi ~ N(0, covariance). That is also an increment of T_world_camera in the
  // camera's own frame: T_world_camera * Exp(-xi). See PoseCovariance(). Zero: not known.
  Matrix6d covariance = Matrix6d::Zero();
};

// information⁻¹ times the variance factor s² of what was measured: whatever noise was assumed, the
// residuals say what there was, that of the landmarks (taken as given) included. s² = 2 cost /
// (measured - 6) (Förstner & Wrobel 2016, eq. 4.89), made larger by what the gate cut off: of
// normal errors within the gate `gate` (chi² with 2 degrees of freedom) the mean of chi² / 2 is 1 -
// (g / 2) / (exp(g / 2) - 1) with g = gate / s². Zero where the matches do not tell a pose: fewer
// than 7 numbers, or a direction nothing was seen of.
Matrix6d PoseCovariance(const Matrix6d& information, double cost, double measured, double gate);

// Starts at `T_camera_world`. Fewer than 3 usable matches: returns the start with no inliers.
// Matches that are not numbers are never inliers. Each round minimises Huber's loss over the
// inliers so far (all at first), then counts as inliers what is within `huber` of the result; at
// the end plain squares over the inliers. ORB-SLAM2 (Mur-Artal & Tardós 2017), eq. 3–4;
// left-multiplied increments as in Solà et al. 2018.
PoseOnlyResult OptimizePose(const Camera& camera, const Se3& T_camera_world,
                            std::span<const PoseMatch> matches,
                            const PoseOnlySettings& settings = {});

}  // namespace alidade
