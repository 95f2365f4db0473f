#include "alidade/view/upright.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace alidade {
namespace {

// Hand-held cameras pitch more than they roll, so their right axes are level. Up is therefore the
// direction most nearly perpendicular to all right axes. When all of them are parallel this is
// undetermined, and the mean of the cameras' up axes decides.
Eigen::Vector3d UpOf(const std::vector<std::vector<Se3>>& path) {
  // Relative to a weight of 1 of the right axes; sin² of 8° of rotation.
  constexpr double kOwnWeight = 0.02;
  Eigen::Vector3d own = Eigen::Vector3d::Zero();
  Eigen::Matrix3d right = Eigen::Matrix3d::Zero();
  double count = 0;
  for (const auto& stretch : path) {
    for (const Se3& T : stretch) {
      own -= T.R.col(1);
      right += T.R.col(0) * T.R.col(0).transpose();
      ++count;
    }
  }
  if (!(own.norm() > 1e-9)) return -Eigen::Vector3d::UnitY();
  own.normalize();
  const Eigen::Matrix3d M = right / count - kOwnWeight * own * own.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(M);
  const Eigen::Vector3d up = solver.eigenvectors().col(0);  // of the smallest eigenvalue
  return up.dot(own) < 0 ? Eigen::Vector3d(-up) : up;
}

}  // namespace

Eigen::Matrix3d UprightAxes(const std::vector<std::vector<Se3>>& path,
                            const std::optional<Eigen::Vector3d>& gravity) {
  const Eigen::Vector3d up = gravity ? Eigen::Vector3d(-*gravity) : UpOf(path);
  Eigen::Vector3d forward =
      path.empty() ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(path.front().front().R.col(2));
  forward -= up * up.dot(forward);
  if (forward.norm() < 1e-3) forward = up.unitOrthogonal();
  forward.normalize();
  Eigen::Matrix3d axes;
  axes.row(0) = forward.cross(up).transpose();
  axes.row(1) = forward.transpose();
  axes.row(2) = up.transpose();
  return axes;
}

}  // namespace alidade
