// RANSAC for homography and fundamental matrix on the same samples, with the score of each
// (Mur-Artal, Montiel & Tardós 2015, §IV, steps 2 and 3).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace alidade {

// 95 % quantile of chi² with 2 and 1 degrees of freedom: outlier threshold of squared distance /
// sigma².
inline constexpr double kChi2Homography = 5.991;
inline constexpr double kChi2Fundamental = 3.841;

struct RansacModel {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();  // H_b_a or F_b_a
  double score = 0;          // eq. 2, summed over both directions of all matches; 0: nothing fits
  std::vector<bool> inlier;  // within the threshold in both images
  int inliers = 0;
};

struct RansacModels {
  RansacModel homography, fundamental;
};

// `a` and `b`: 8 or more finite image points in units of sigma, with the origin near the image
// center (single precision is used). The models of the best samples are re-estimated from their
// inliers as long as the score rises. `parallel` uses the threads of base/parallel.h; the result is
// the same.
RansacModels FitTwoViewModels(std::span<const Eigen::Vector2d> a,
                              std::span<const Eigen::Vector2d> b, int iterations, uint64_t seed,
                              bool parallel);

}  // namespace alidade
