// Homography and fundamental matrix of the same matches by RANSAC on the same samples, and how well
// each explains them (Mur-Artal, Montiel & Tardós 2015, §IV, steps 2 and 3).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace alidade {

// 95 % of chi² with 2 and with 1 degree of freedom: beyond it, a squared distance over sigma² makes
// an outlier.
inline constexpr double kChi2Homography = 5.991;
inline constexpr double kChi2Fundamental = 3.841;

struct RansacModel {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();  // maps or binds a to b
  double score = 0;          // eq. 2, over both directions of all matches; 0: nothing fits
  std::vector<bool> inlier;  // within the bound in both images
  int inliers = 0;
};

struct RansacModels {
  RansacModel homography, fundamental;
};

// `a` and `b`: image points in units of sigma, the origin near the middle of the image (single
// precision is used), 8 or more, finite. The best sample's model is estimated again from its
// inliers as long as that raises its score. With `parallel`, over the threads of base/parallel.h;
// the result is the same.
RansacModels FitTwoViewModels(std::span<const Eigen::Vector2d> a,
                              std::span<const Eigen::Vector2d> b, int iterations, uint64_t seed,
                              bool parallel);

}  // namespace alidade
