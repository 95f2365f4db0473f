#include "alidade/inertial/map_bridge.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "alidade/inertial/largest_sigma.h"

namespace alidade {
namespace {

constexpr double kChiSquared3 = 16.3, kChiSquared2 = 13.8;  // 99.9 %
constexpr int kVelocity = 3, kPosition = 6, kTiltAt = MotionBelief::kState + kTilt;

}  // namespace

std::optional<MapBridge> BridgeOf(const MotionBelief& a, const MotionBelief& b) {
  const Eigen::Matrix3d R_a_b = a.state.T_world_imu.R * b.state.T_world_imu.R.transpose();
  const auto block = [](const MotionBelief& belief, int row, int column) -> Eigen::Matrix3d {
    return belief.covariance.block<3, 3>(row, column);
  };
  const auto in_a = [&](int row, int column) -> Eigen::Matrix3d {
    return R_a_b * block(b, row, column) * R_a_b.transpose();
  };
  // Errors of the rotation are about the axes of the sensor, which both share.
  const Eigen::Matrix3d rotation = block(a, 0, 0) + block(b, 0, 0);

  const Eigen::Matrix<double, 3, 2> tangents = TangentsOf(a.common.down);
  const Eigen::Vector2d tilt = tangents.transpose() * a.common.down.cross(R_a_b * b.common.down);
  const Eigen::Matrix<double, 3, 2> tangents_b = TangentsOf(b.common.down);
  const Eigen::Matrix3d turned =
      a.state.T_world_imu.R * rotation * a.state.T_world_imu.R.transpose() +
      R_a_b * tangents_b * b.covariance.block<2, 2>(kTiltAt, kTiltAt) * tangents_b.transpose() *
          R_a_b.transpose();
  const Eigen::Matrix2d tilts =
      a.covariance.block<2, 2>(kTiltAt, kTiltAt) + tangents.transpose() * turned * tangents;
  if (!(tilt.dot(tilts.llt().solve(tilt)) < kChiSquared2)) return std::nullopt;

  // The velocity of b in a, wrong also by the error of the rotation between them.
  const Eigen::Vector3d velocity_b = R_a_b * b.state.velocity;
  const Eigen::Matrix3d by_turn = Skew(velocity_b) * a.state.T_world_imu.R;
  const Eigen::Matrix3d innovation = block(a, kVelocity, kVelocity) + in_a(kVelocity, kVelocity) +
                                     by_turn * rotation * by_turn.transpose();
  const Eigen::LLT<Eigen::Matrix3d> solver(innovation);
  const Eigen::Vector3d difference = velocity_b - a.state.velocity;
  if (!(difference.dot(solver.solve(difference)) < kChiSquared3)) return std::nullopt;
  const Eigen::Matrix3d across = block(a, kPosition, kVelocity);
  const Eigen::Vector3d position = a.state.T_world_imu.t + across * solver.solve(difference);

  MapBridge bridge;
  bridge.T_a_b.s = b.common.scale / a.common.scale;
  bridge.T_a_b.R = R_a_b;
  bridge.T_a_b.t = (position - R_a_b * b.state.T_world_imu.t) / a.common.scale;
  bridge.sigma =
      LargestSigma(block(a, kPosition, kPosition) - across * solver.solve(across.transpose()) +
                   in_a(kPosition, kPosition));
  bridge.rotation = LargestSigma(rotation);
  return bridge;
}

}  // namespace alidade
