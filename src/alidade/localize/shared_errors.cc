#include "alidade/localize/shared_errors.h"

#include <Eigen/Cholesky>

#include "alidade/base/id_map.h"

namespace alidade {
namespace {

struct Sum {
  Vector6d value = Vector6d::Zero();
};

}  // namespace

Matrix6d SharedErrors(const PlacedFrame& placed, const Camera& camera, const MapSnapshot& map,
                      const MeasurementNoise& noise) {
  Matrix6d H = Matrix6d::Zero();
  IdMap<KeyFrameId, Sum> sums;
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    const Landmark* landmark = placed.matches[i].valid() ? map.Find(placed.matches[i]) : nullptr;
    if (!landmark) continue;
    const Eigen::Vector3d p = placed.T_camera_world * landmark->p_world;
    const Measurement measured = Measure(placed.frame->keypoints[i], noise);
    const Eigen::Vector2d residual = camera.Project(p) - measured.pixel.head<2>();
    Eigen::Matrix<double, 2, 6> J;
    J.leftCols<3>() << camera.fx / p.z(), 0, -camera.fx * p.x() / (p.z() * p.z()), 0,
        camera.fy / p.z(), -camera.fy * p.y() / (p.z() * p.z());
    J.rightCols<3>() = -J.leftCols<3>() * Skew(p);
    H += measured.inv_sigma2 * J.transpose() * J;
    Sum& sum = sums[landmark->reference];
    sum.value += measured.inv_sigma2 * J.transpose() * residual;
  }
  const auto count = static_cast<double>(sums.size());
  const Eigen::LLT<Matrix6d> solver(H);
  if (count < 2 || solver.info() != Eigen::Success) return Matrix6d::Zero();
  Matrix6d scatter = Matrix6d::Zero();
  for (const auto& [keyframe, sum] : sums.entries()) {
    const Vector6d moved = solver.solve(sum.value);
    scatter += moved * moved.transpose();
  }
  return count / (count - 1) * scatter;
}

}  // namespace alidade
