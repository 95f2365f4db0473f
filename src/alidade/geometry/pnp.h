// Pose of a camera from landmarks and where they are seen, with many wrong matches among them.
// Three points give up to four poses (Lambda Twist, Persson & Nordberg 2018, or Grunert's quartic);
// RANSAC around it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

// Poses T_camera_world from three landmarks and the unit rays to them in the camera frame; 0 to 4
// of them.
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
  Se3 T_camera_world;  // of the best sample, refined over its inliers; see optimize/pose_only.h
  std::vector<bool> inlier;  // one for each match
  int inliers = 0;
};

// `sigma_scale` (one for each match, or empty): the keypoint's pyramid scale; multiplies max_error.
PnpResult SolvePnpRansac(const Camera& camera, std::span<const Eigen::Vector3d> p_world,
                         std::span<const Eigen::Vector2d> pixels,
                         std::span<const double> sigma_scale = {},
                         const PnpSettings& settings = {});

}  // namespace alidade
