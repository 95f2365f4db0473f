// The similarity, or rigid motion, between two cameras' frames from points known in both, with many
// wrong matches among them: three points in closed form (Horn 1987; here alignment.h), RANSAC
// around it, inliers by reprojection in both images (Mur-Artal, Montiel & Tardós 2015, §VII-B).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

struct Sim3Match {
  Eigen::Vector3d p_a, p_b;          // the point in camera a's and in camera b's frame, map units
  Eigen::Vector2d pixel_a, pixel_b;  // where each saw it, undistorted
  double sigma_a = 1, sigma_b = 1;   // pixels, standard deviation with the pyramid level's scale
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
  Sim3 T_a_b;                // to be refined by optimize/sim3_refine.h
  std::vector<bool> inlier;  // one for each match
  int inliers = 0;
};

// Matches that are not numbers are never inliers, nor are those behind either camera. Points on one
// line give no answer: the turn about it is anyone's guess.
Sim3RansacResult SolveSim3Ransac(const Camera& camera, std::span<const Sim3Match> matches,
                                 const Sim3RansacSettings& settings = {});

}  // namespace alidade
