// Similarity or rigid motion between two camera frames from 3D-3D matches with outliers: closed
// form on three points (Horn 1987; here alignment.h) inside RANSAC, inliers by reprojection error
// in both images (Mur-Artal, Montiel & Tardós 2015, §VII-B).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

struct Sim3Match {
  Eigen::Vector3d p_a, p_b;          // the point in the frames of cameras a and b, map units
  Eigen::Vector2d pixel_a, pixel_b;  // observed in each image, undistorted
  double sigma_a = 1, sigma_b = 1;   // standard deviation at the keypoint's pyramid level, pixels
};

struct Sim3RansacSettings {
  int max_iterations = 300;   // samples
  double max_error = 3.0;     // standard deviations, an inlier's reprojection error in each image
  double confidence = 0.999;  // stops once this sure to have had a good sample
  int min_inliers = 15;
  bool with_scale = true;  // false: both maps have the same unit, scale is held at 1
  uint64_t seed = 1;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

struct Sim3RansacResult {
  bool success = false;
  Sim3 T_a_b;                // optimize/sim3_refine.h refines it
  std::vector<bool> inlier;  // one per match
  int inliers = 0;
};

// Non-finite matches and points behind either camera are never inliers. Collinear points give no
// result, because the rotation about their line is undetermined.
Sim3RansacResult SolveSim3Ransac(const Camera& camera, std::span<const Sim3Match> matches,
                                 const Sim3RansacSettings& settings = {});

}  // namespace alidade
