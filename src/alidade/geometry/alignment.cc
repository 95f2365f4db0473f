#include "alidade/geometry/alignment.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>

#include "alidade/base/error.h"

namespace alidade {
namespace {

struct Moments {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double variance = 0;  // mean squared distance from the mean
};

Moments MomentsOf(std::span<const Eigen::Vector3d> points, const char* name) {
  Moments moments;
  double largest = 0;
  for (const Eigen::Vector3d& p : points) {
    if (!p.allFinite()) {
      ThrowInput("alignment: point " + std::to_string(&p - points.data()) + " of the " + name +
                 " is not finite");
    }
    moments.mean += p;
    largest = std::max(largest, p.cwiseAbs().maxCoeff());
  }
  const auto count = static_cast<double>(points.size());
  moments.mean /= count;
  for (const Eigen::Vector3d& p : points) moments.variance += (p - moments.mean).squaredNorm();
  moments.variance /= count;
  if (!std::isfinite(moments.variance)) {
    ThrowInput(std::string("alignment: the points of the ") + name + " are too large");
  }
  // The variance of coincident points is rounding noise, about 1e-16 of the coordinates.
  const double rounding = 1e-14 * largest;
  if (moments.variance <= rounding * rounding) {
    ThrowInput(std::string("alignment: all points of the ") + name +
               " are the same point; the motion between the two is undefined");
  }
  return moments;
}

}  // namespace

Sim3 AlignPoints(std::span<const Eigen::Vector3d> target, std::span<const Eigen::Vector3d> source,
                 bool with_scale) {
  if (target.size() != source.size()) {
    ThrowInput("alignment: " + std::to_string(target.size()) + " target points but " +
               std::to_string(source.size()) + " source points");
  }
  if (target.size() < 3) {
    ThrowInput("alignment: needs at least 3 pairs of points, there are " +
               std::to_string(target.size()));
  }
  const Moments moments_target = MomentsOf(target, "target");
  const Moments moments_source = MomentsOf(source, "source");

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // Umeyama eq. 38
  for (size_t i = 0; i < target.size(); ++i) {
    covariance += (target[i] - moments_target.mean) * (source[i] - moments_source.mean).transpose();
  }
  covariance /= static_cast<double>(target.size());

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Eq. 39/43: flip the weakest axis instead of returning a reflection. For collinear points (rank
  // 1) the rotation about their line is arbitrary.
  Eigen::Vector3d sign(1, 1,
                       svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1);
  Sim3 T_target_source;
  T_target_source.R = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();  // eq. 40
  if (with_scale) {
    T_target_source.s = svd.singularValues().dot(sign) / moments_source.variance;  // eq. 42
    // The two shapes are unrelated if the best similarity shrinks one to a point.
    const double unit = std::sqrt(moments_target.variance / moments_source.variance);
    if (!(T_target_source.s > 1e-12 * unit)) {
      ThrowInput("alignment: the two sets of points are unrelated; no scale fits them");
    }
  }
  T_target_source.t = moments_target.mean -
                      T_target_source.s * (T_target_source.R * moments_source.mean);  // eq. 41
  return T_target_source;
}

}  // namespace alidade
