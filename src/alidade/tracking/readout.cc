#include "alidade/tracking/readout.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "alidade/optimize/reprojection.h"

namespace alidade {
namespace {

constexpr size_t kLeastMatches = 30;  // per frame; its pose has six unknowns

}  // namespace

void ReadoutSum::Add(const Vector6d& motion, std::span<const ReadoutMatch> matches) {
  if (matches.size() < kLeastMatches || motion.isZero(0)) return;
  const int along = camera_.ReadAlong();
  double H = 0, g = 0;
  Matrix6d H_pose = Matrix6d::Zero();
  Vector6d g_pose = Vector6d::Zero();
  Eigen::RowVector<double, 6> across = Eigen::RowVector<double, 6>::Zero();
  for (const ReadoutMatch& m : matches) {
    const Eigen::Vector3d& p = m.p_camera;
    if (!(p.z() > kMinDepth)) continue;
    Eigen::Matrix<double, 2, 3> by_p;
    by_p << camera_.fx / p.z(), 0, -camera_.fx * p.x() / (p.z() * p.z()), 0, camera_.fy / p.z(),
        -camera_.fy * p.y() / (p.z() * p.z());
    Eigen::Matrix3d cross;
    cross << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
    Eigen::Matrix<double, 2, 6> B;
    B << by_p, -by_p * cross;
    const Eigen::Vector2d flow = B * motion;  // pixels per second
    const Eigen::Vector2d A = flow * (along == 0 ? (m.raw.x() + 0.5) / camera_.width - 0.5
                                                 : (m.raw.y() + 0.5) / camera_.height - 0.5);
    H += m.weight * A.squaredNorm();
    g += m.weight * A.dot(m.residual);
    H_pose += m.weight * B.transpose() * B;
    g_pose += m.weight * B.transpose() * m.residual;
    across += m.weight * A.transpose() * B;
    chi2_ += m.weight * m.residual.squaredNorm();
    measured_ += 2;
  }
  const Eigen::LDLT<Matrix6d> pose(H_pose);
  H_ += H - across.dot(pose.solve(across.transpose()));
  g_ += g - across.dot(pose.solve(g_pose));
  ++frames_;
}

ReadoutSum::Told ReadoutSum::told() const {
  Told told;
  told.frames = frames_;
  told.sigma = std::numeric_limits<double>::infinity();
  if (!(H_ > 0) || !(measured_ > 0)) return told;
  told.change = g_ / H_;
  told.explained = g_ * told.change / chi2_;
  told.sigma = std::sqrt(chi2_ / measured_ / H_);
  return told;
}

}  // namespace alidade
