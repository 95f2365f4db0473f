#include <Eigen/Geometry>
#include <cmath>

#include "alidade/geometry/smallest_eigenvector.h"
#include "alidade/geometry/two_view.h"

namespace alidade {

std::optional<Eigen::Vector3d> Triangulate(const Camera& camera, const Se3& T_a_world,
                                           const Eigen::Vector2d& pixel_a, const Se3& T_b_world,
                                           const Eigen::Vector2d& pixel_b) {
  // Solve in the frame of a with the baseline as unit: well scaled at any distance from the world
  // origin and for any baseline.
  const Se3 T_b_a = T_b_world * T_a_world.Inverse();
  const double baseline = T_b_a.t.norm();
  if (!(baseline > 0)) return std::nullopt;
  const Eigen::Vector3d ray_a = camera.Unproject(pixel_a), ray_b = camera.Unproject(pixel_b);
  Eigen::Matrix<double, 3, 4> P_b;
  P_b << T_b_a.R, T_b_a.t / baseline;
  Eigen::Matrix4d A;  // Hartley & Zisserman 12.2
  A.row(0) << -1, 0, ray_a.x(), 0;
  A.row(1) << 0, -1, ray_a.y(), 0;
  A.row(2) = ray_b.x() * P_b.row(2) - P_b.row(0);
  A.row(3) = ray_b.y() * P_b.row(2) - P_b.row(1);
  const Eigen::Vector4d X = SmallestEigenvector<4>(A.transpose() * A);
  const Eigen::Vector3d p_a = X.head<3>() * (baseline / X[3]);
  const Eigen::Vector3d p_b = T_b_a * p_a;
  if (!p_a.allFinite() || !(p_a.z() > 0) || !(p_b.z() > 0)) return std::nullopt;
  return T_a_world.Inverse() * p_a;
}

}  // namespace alidade
