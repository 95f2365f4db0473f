#include "alidade/geometry/homography.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

#include "alidade/geometry/normalise_points.h"
#include "alidade/geometry/smallest_eigenvector.h"

namespace alidade {

Eigen::Matrix3d EstimateHomography(std::span<const Eigen::Vector2d> a,
                                   std::span<const Eigen::Vector2d> b) {
  const PointNormalisation normal_a(a), normal_b(b);
  // Each pair gives two rows of A (Hartley & Zisserman eq. 4.3): (p, 0, -u p) and (0, p, -v p) for
  // b = (u, v), p = (a, 1). A' A consists of 3x3 blocks that are sums of p p'.
  Eigen::Matrix3d plain = Eigen::Matrix3d::Zero(), with_u = plain, with_v = plain, squared = plain;
  for (size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d pa = normal_a.Apply(a[i]), pb = normal_b.Apply(b[i]);
    const Eigen::Matrix3d outer = pa * pa.transpose();
    plain += outer;
    with_u += pb.x() * outer;
    with_v += pb.y() * outer;
    squared += pb.head<2>().squaredNorm() * outer;
  }
  Eigen::Matrix<double, 9, 9> m = Eigen::Matrix<double, 9, 9>::Zero();
  m.block<3, 3>(0, 0) = plain;
  m.block<3, 3>(3, 3) = plain;
  m.block<3, 3>(6, 0) = -with_u;  // only the lower triangle is read
  m.block<3, 3>(6, 3) = -with_v;
  m.block<3, 3>(6, 6) = squared;
  const Eigen::Matrix<double, 9, 1> h = SmallestEigenvector<9>(m);
  Eigen::Matrix3d H;
  H << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  H = normal_b.Inverse() * H * normal_a.Matrix();
  return H / H.norm();
}

std::vector<Se3> MotionsFromHomography(const Eigen::Matrix3d& H_b_a) {
  if (!H_b_a.allFinite()) return {};
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H_b_a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d &U = svd.matrixU(), &V = svd.matrixV();
  const Eigen::Vector3d d = svd.singularValues();
  const double d1 = d[0], d2 = d[1], d3 = d[2];
  // All singular values equal: pure rotation. Two equal: the translation is along the plane's
  // normal, and the formulas below still hold.
  if (!(d3 > 1e-9 * d1) || (d1 - d3) < 1e-6 * d2) return {};
  const double s = U.determinant() * V.determinant() < 0 ? -1 : 1;

  const double spread = d1 * d1 - d3 * d3;
  const double x1 = std::sqrt((d1 * d1 - d2 * d2) / spread);  // eq. 12
  const double x3 = std::sqrt((d2 * d2 - d3 * d3) / spread);
  const double root = std::sqrt((d1 * d1 - d2 * d2) * (d2 * d2 - d3 * d3));
  std::vector<Se3> motions;
  for (const double e1 : {1.0, -1.0}) {
    for (const double e3 : {1.0, -1.0}) {
      {  // d' = d2 > 0: eq. 13, 14
        const double sine = e1 * e3 * root / ((d1 + d3) * d2);
        const double cosine = (d2 * d2 + d1 * d3) / ((d1 + d3) * d2);
        Eigen::Matrix3d R;
        R << cosine, 0, -sine, 0, 1, 0, sine, 0, cosine;
        const Eigen::Vector3d t(e1 * x1, 0, -e3 * x3);
        motions.push_back({s * U * R * V.transpose(), (U * t).normalized()});
      }
      {  // d' = -d2 < 0, cameras on opposite sides of the plane: eq. 15, 16
        const double sine = e1 * e3 * root / ((d1 - d3) * d2);
        const double cosine = (d1 * d3 - d2 * d2) / ((d1 - d3) * d2);
        Eigen::Matrix3d R;
        R << cosine, 0, sine, 0, -1, 0, sine, 0, -cosine;
        const Eigen::Vector3d t(e1 * x1, 0, e3 * x3);
        motions.push_back({s * U * R * V.transpose(), (U * t).normalized()});
      }
    }
  }
  return motions;
}

}  // namespace alidade
