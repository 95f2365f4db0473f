#include "alidade/optimize/bundle_motion_terms.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/optimize/bundle_linearise.h"

namespace alidade {
namespace {

using Matrix96 = Eigen::Matrix<double, 9, 6>;

void CheckMotion(const BundleMotion& motion, int cameras) {
  for (const BundleMotionState& state : motion.states) {
    if (state.camera < 0 || state.camera >= cameras)
      ThrowUsage("bundle problem: an inertial state names a camera that is not there");
  }
  const int states = static_cast<int>(motion.states.size());
  for (const BundleMotionLink& link : motion.links) {
    if (std::min(link.from, link.to) < 0 || std::max(link.from, link.to) >= states ||
        link.from == link.to)
      ThrowUsage("bundle problem: a motion names an inertial state that is not there");
    if (!(link.accel_walk > 0)) ThrowUsage("bundle problem: accel_walk must be above 0");
  }
}

Matrix9d WhiteningOf(const Matrix9d& covariance) {
  const Eigen::LLT<Matrix9d> factor(covariance);
  if (factor.info() != Eigen::Success)
    ThrowUsage("bundle problem: the covariance of a motion is singular");
  return factor.solve(Matrix9d::Identity()).llt().matrixU();
}

// A link's contributions are within the rows of camera and state `from`, camera and state `to`.
constexpr int kRows = 4;

InertialState StateOf(const BundleCamera& camera, const BundleMotionState& motion,
                      const Se3& T_camera_imu, const Eigen::Vector3d& gyro_bias) {
  InertialState state;
  state.T_world_imu = Se3{camera.R.transpose(), camera.centre} * T_camera_imu;
  state.velocity = motion.velocity;
  state.bias = {gyro_bias, motion.accel_bias};
  return state;
}

// Derivatives of the whitened error by the increments of the four rows.
std::array<Matrix96, kRows> DerivativesOf(const MotionResidual& r, const InertialState& i,
                                          const InertialState& j, const Se3& T_camera_imu,
                                          const Matrix9d& U) {
  // A step (ρ, θ) of a camera (bundle_linearise.h) turns the sensor by -R'θ and moves it by
  // -ρ + [a]x θ, where a is the way from the camera to the sensor, in world axes.
  const auto by_camera = [&](const Matrix9d& by, const Eigen::Matrix3d& R_world_imu) {
    const Eigen::Vector3d a = R_world_imu * (T_camera_imu.R.transpose() * T_camera_imu.t);
    Matrix96 J;
    J.leftCols<3>() = -by.rightCols<3>();
    J.rightCols<3>() = by.rightCols<3>() * Skew(a) - by.leftCols<3>() * R_world_imu.transpose();
    return Matrix96(U * J);
  };
  Matrix96 by_from = Matrix96::Zero(), by_to = Matrix96::Zero();
  by_from << r.by_i.middleCols<3>(3), r.by_bias.rightCols<3>();
  by_to.leftCols<3>() = r.by_j.middleCols<3>(3);
  return {by_camera(r.by_i, i.T_world_imu.R), U * by_from, by_camera(r.by_j, j.T_world_imu.R),
          U * by_to};
}

void AddNormal(const MotionLayout& layout, int row, const Matrix6d& H, const Vector6d& g,
               Linearisation& result) {
  if (row < layout.first_row) {
    result.cameras[row].Add(H, g);
  } else {
    result.states[row - layout.first_row].H += H;
    result.states[row - layout.first_row].g += g;
  }
}

void AddLink(const MotionLayout& layout, const MotionLayout::Link& at, const BundleState& state,
             Linearisation& result) {
  const BundleMotionLink& link = *at.link;
  const Eigen::Vector3d& gyro_bias = link.motion.bias.gyro;
  const BundleMotionState &from = state.motion[link.from], &to = state.motion[link.to];
  const InertialState i = StateOf(state.cameras[from.camera], from, layout.T_camera_imu, gyro_bias);
  const InertialState j = StateOf(state.cameras[to.camera], to, layout.T_camera_imu, gyro_bias);
  const MotionResidual residual = ResidualOf(i, j, link.motion, layout.gravity);
  const Vector9d e = at.whitening * residual.error;
  const std::array<Matrix96, kRows> J =
      DerivativesOf(residual, i, j, layout.T_camera_imu, at.whitening);
  result.cost += 0.5 * e.squaredNorm();
  for (int a = 0; a < kRows; ++a) {
    if (at.rows[a] < 0) continue;
    AddNormal(layout, at.rows[a], J[a].transpose() * J[a], J[a].transpose() * e, result);
    for (int b = 0; b < kRows; ++b) {
      if (at.blocks[a][b] >= 0) result.motion[at.blocks[a][b]] += J[a].transpose() * J[b];
    }
  }

  // Random walk of the accelerometer's bias.
  const double weight = 1 / (link.accel_walk * link.accel_walk);
  const Eigen::Vector3d walk = to.accel_bias - from.accel_bias;
  result.cost += 0.5 * weight * walk.squaredNorm();
  Matrix6d H = Matrix6d::Zero();
  H.diagonal().tail<3>().setConstant(weight);
  Vector6d g = Vector6d::Zero();
  g.tail<3>() = weight * walk;
  AddNormal(layout, at.rows[1], H, -g, result);
  AddNormal(layout, at.rows[3], H, g, result);
  for (const auto& [a, b] : {std::pair(1, 3), std::pair(3, 1)}) {
    if (at.blocks[a][b] >= 0) result.motion[at.blocks[a][b]] -= H;
  }
}

}  // namespace

MotionLayout LayOutMotion(const BundleMotion& motion, const std::vector<int>& slots,
                          int free_cameras) {
  CheckMotion(motion, static_cast<int>(slots.size()));
  MotionLayout layout;
  layout.T_camera_imu = motion.T_camera_imu;
  layout.gravity = motion.gravity;
  layout.start = motion.states;
  layout.first_row = free_cameras;
  std::map<std::pair<int, int>, int> known;  // index of (row, column)
  for (const BundleMotionLink& link : motion.links) {
    MotionLayout::Link at;
    at.link = &link;
    at.rows = {slots[motion.states[link.from].camera], free_cameras + link.from,
               slots[motion.states[link.to].camera], free_cameras + link.to};
    for (int a = 0; a < kRows; ++a) {
      for (int b = 0; b < kRows; ++b) {
        at.blocks[a][b] = -1;
        if (at.rows[b] < 0 || at.rows[a] <= at.rows[b]) continue;
        const auto [entry, is_new] =
            known.try_emplace({at.rows[a], at.rows[b]}, static_cast<int>(layout.blocks.size()));
        if (is_new) layout.blocks.push_back({at.rows[a], at.rows[b]});
        at.blocks[a][b] = entry->second;
      }
    }
    at.whitening = WhiteningOf(link.covariance);
    layout.links.push_back(at);
  }
  return layout;
}

void AddMotion(const MotionLayout& layout, const BundleState& state, Linearisation& result) {
  result.states.assign(layout.start.size(), {});
  result.motion.assign(layout.blocks.size(), Matrix6d::Zero());
  for (const MotionLayout::Link& link : layout.links) AddLink(layout, link, state, result);
  for (size_t k = 0; k < layout.start.size(); ++k) {
    const BundleMotionState& prior = layout.start[k];
    if (!(prior.accel_bias_sigma > 0)) continue;
    const double weight = 1 / (prior.accel_bias_sigma * prior.accel_bias_sigma);
    const Eigen::Vector3d off = state.motion[k].accel_bias - prior.accel_bias;
    result.cost += 0.5 * weight * off.squaredNorm();
    result.states[k].H.diagonal().tail<3>().array() += weight;
    result.states[k].g.tail<3>() += weight * off;
  }
}

}  // namespace alidade
