// Camera pose from 3D-2D matches with outliers: P3P (Lambda Twist, Persson & Nordberg 2018) inside
// RANSAC.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

// Returns the 0 to 4 poses T_camera_world for three landmarks in the world frame and the unit rays
// to them in the camera frame. Collinear or non-finite points give none.
std::vector<Se3> SolveP3p(const Eigen::Vector3d p_world[3], const Eigen::Vector3d rays[3]);

struct PnpSettings {
  int max_iterations = 300;  // samples
  // Drawn whatever was found. A sample free of outliers is not yet a good one: three points in a
  // corner of the picture leave the pose open by as much as the camera has moved, and nearly all
  // others in that corner agree.
  int min_iterations = 20;
  double max_error = 3.0;     // pixels, an inlier's reprojection error
  double confidence = 0.999;  // stops once this sure to have had a good sample
  int min_inliers = 10;
  uint64_t seed = 1;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

struct PnpResult {
  bool success = false;
  // Best sample's pose after a few Gauss-Newton steps over its inliers; optimize/pose_only.h
  // refines it further.
  Se3 T_camera_world;
  std::vector<bool> inlier;  // one per match
  int inliers = 0;
};

// `p_world` in meters, `pixels` undistorted, both of the same length. `sigma_scale` (one per match,
// or empty) is the keypoint's pyramid scale and multiplies max_error.
PnpResult SolvePnpRansac(const Camera& camera, std::span<const Eigen::Vector3d> p_world,
                         std::span<const Eigen::Vector2d> pixels,
                         std::span<const double> sigma_scale = {},
                         const PnpSettings& settings = {});

}  // namespace alidade
