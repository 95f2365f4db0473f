#include "alidade/geometry/fundamental.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "alidade/geometry/normalise_points.h"
#include "alidade/geometry/smallest_eigenvector.h"

namespace alidade {

Eigen::Matrix3d EstimateFundamental(std::span<const Eigen::Vector2d> a,
                                    std::span<const Eigen::Vector2d> b) {
  const PointNormalisation normal_a(a), normal_b(b);
  // Each pair is one row of A, kron(b, a); A' A is summed from its 3x3 blocks.
  Eigen::Matrix<double, 9, 9> m = Eigen::Matrix<double, 9, 9>::Zero();
  for (size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d pa = normal_a.Apply(a[i]), pb = normal_b.Apply(b[i]);
    const Eigen::Matrix3d outer = pa * pa.transpose();
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col <= row; ++col) {
        m.block<3, 3>(3 * row, 3 * col) += (pb[row] * pb[col]) * outer;
      }
    }
  }
  const Eigen::Matrix<double, 9, 1> f = SmallestEigenvector<9>(m);  // reads only the lower triangle
  Eigen::Matrix3d F;
  F << f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8];
  // Enforce rank 2: subtract the component of the weakest right singular vector.
  const Eigen::Vector3d weakest = SmallestEigenvector<3>(F.transpose() * F);
  F -= (F * weakest) * weakest.transpose();
  F = normal_b.Matrix().transpose() * F * normal_a.Matrix();
  return F / F.norm();
}

std::vector<Se3> MotionsFromEssential(const Eigen::Matrix3d& E_b_a) {
  if (!E_b_a.allFinite()) return {};
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(E_b_a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU(), V = svd.matrixV();
  if (U.determinant() < 0) U = -U;
  if (V.determinant() < 0) V = -V;
  Eigen::Matrix3d W;
  W << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Matrix3d R1 = U * W * V.transpose(), R2 = U * W.transpose() * V.transpose();
  const Eigen::Vector3d t = U.col(2);
  return {{R1, t}, {R1, -t}, {R2, t}, {R2, -t}};
}

}  // namespace alidade
