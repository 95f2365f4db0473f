// Translates and scales points to zero mean and a mean distance of sqrt(2) from the origin. The
// linear methods are badly conditioned without it (Hartley & Zisserman 4.4.4).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>

namespace alidade {

struct PointNormalisation {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double scale = 1;  // normalised = scale * (point - mean)

  explicit PointNormalisation(std::span<const Eigen::Vector2d> points) {
    for (const Eigen::Vector2d& p : points) mean += p;
    mean /= static_cast<double>(points.size());
    double distance = 0;
    for (const Eigen::Vector2d& p : points) distance += (p - mean).norm();
    if (distance > 0) scale = std::sqrt(2.0) * static_cast<double>(points.size()) / distance;
  }

  Eigen::Vector3d Apply(const Eigen::Vector2d& p) const {
    return (scale * (p - mean)).homogeneous();
  }

  Eigen::Matrix3d Matrix() const {
    Eigen::Matrix3d m;
    m << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
    return m;
  }
  Eigen::Matrix3d Inverse() const {
    Eigen::Matrix3d m;
    m << 1 / scale, 0, mean.x(), 0, 1 / scale, mean.y(), 0, 0, 1;
    return m;
  }
};

}  // namespace alidade
