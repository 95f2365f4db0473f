#include "alidade/geometry/rotation_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "alidade/base/median.h"
#include "alidade/geometry/se3.h"

namespace alidade {
namespace {

constexpr int kIterations = 10;
constexpr double kEnough = 1e-6;         // radians: a step below it is the last
constexpr double kMedianOfNorm = 1.177;  // of a 2-vector with unit variances: sqrt(2 ln 2)
constexpr double kLossWidth = 3;         // standard deviations: the weight there is a quarter
constexpr double kInlier = 3;

// Chains of products would leave the rotations exponentially fast, where one is the start of the
// next.
Eigen::Matrix3d Orthonormal(const Eigen::Matrix3d& R) {
  return Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

// Standard deviation along each axis from the median length of the residuals.
double ScaleOf(std::vector<double> lengths, double least) {
  return std::max(least, UpperMedian(lengths) / kMedianOfNorm);
}

}  // namespace

RotationFit FitRotation(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b,
                        const Eigen::Matrix3d& start, double least_residual) {
  RotationFit fit;
  fit.R_a_b = Orthonormal(start);
  if (a.size() < 3 || a.size() != b.size()) return fit;
  std::vector<double> lengths(a.size());
  const auto measure = [&] {
    for (size_t i = 0; i < a.size(); ++i) lengths[i] = (a[i] - fit.R_a_b * b[i]).norm();
    fit.residual = ScaleOf(lengths, least_residual);
  };
  measure();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    // R Exp(e) b = R (b + e x b); least squares of R' a - b - e x b.
    const double width = kLossWidth * fit.residual;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < a.size(); ++i) {
      const double ratio = lengths[i] / width;
      const double weight = 1 / ((1 + ratio * ratio) * (1 + ratio * ratio));
      normal +=
          weight * (b[i].squaredNorm() * Eigen::Matrix3d::Identity() - b[i] * b[i].transpose());
      right += weight * b[i].cross(fit.R_a_b.transpose() * a[i]);
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (solver.info() != Eigen::Success || !solver.isPositive()) return fit;
    const Eigen::Vector3d step = solver.solve(right);
    if (!step.allFinite()) return fit;
    fit.R_a_b = Orthonormal(fit.R_a_b * ExpSo3(step));
    measure();
    if (step.norm() < kEnough) break;
  }
  for (size_t i = 0; i < a.size(); ++i) {
    if (lengths[i] > kInlier * fit.residual) continue;
    ++fit.inliers;
    fit.information += b[i].squaredNorm() * Eigen::Matrix3d::Identity() - b[i] * b[i].transpose();
  }
  if (fit.inliers > 0) fit.information /= fit.inliers;
  return fit;
}

}  // namespace alidade
