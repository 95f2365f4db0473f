// The inertial residuals of bundle adjustment for Ceres, with numeric derivatives.
#pragma once

#include <ceres/ceres.h>

#include <vector>

#include "alidade/optimize/bundle_motion.h"
#include "ceres_reprojection.h"

namespace alidade {

struct CeresMotion {
  const BundleMotion* motion;
  const BundleMotionLink* link;
  Matrix9d whitening;

  InertialState StateOf(const double* pose, const double* velocity, const double* bias) const {
    InertialState state;
    state.T_world_imu =
        FromCeresPose(Eigen::Map<const Vector6d>(pose)).Inverse() * motion->T_camera_imu;
    state.velocity = Eigen::Map<const Eigen::Vector3d>(velocity);
    state.bias = {link->motion.bias.gyro, Eigen::Map<const Eigen::Vector3d>(bias)};
    return state;
  }
  bool operator()(const double* pose_i, const double* velocity_i, const double* bias_i,
                  const double* pose_j, const double* velocity_j, const double* bias_j,
                  double* residual) const {
    const InertialState i = StateOf(pose_i, velocity_i, bias_i),
                        j = StateOf(pose_j, velocity_j, bias_j);
    Eigen::Map<Eigen::Matrix<double, 12, 1>> r(residual);
    r.head<9>() = whitening * ResidualOf(i, j, link->motion, motion->gravity).error;
    r.tail<3>() = (j.bias.accel - i.bias.accel) / link->accel_walk;
    return true;
  }
};

struct CeresBiasPrior {
  Eigen::Vector3d bias;
  double sigma;
  template <typename T>
  bool operator()(const T* of_state, T* residual) const {
    for (int i = 0; i < 3; ++i) residual[i] = (of_state[i] - bias[i]) / sigma;
    return true;
  }
};

// `poses`: one per camera. `ordering`: states are eliminated with the poses, in group 1.
inline void AddCeresMotion(BundleMotion& motion, std::vector<Vector6d>& poses,
                           ceres::Problem& problem, ceres::ParameterBlockOrdering& ordering) {
  for (const BundleMotionLink& link : motion.links) {
    const Matrix9d information = link.covariance.inverse();
    auto* cost =
        new ceres::NumericDiffCostFunction<CeresMotion, ceres::RIDDERS, 12, 6, 3, 3, 6, 3, 3>(
            new CeresMotion{&motion, &link, Matrix9d(information.llt().matrixU())});
    BundleMotionState &i = motion.states[link.from], &j = motion.states[link.to];
    problem.AddResidualBlock(cost, nullptr, poses[i.camera].data(), i.velocity.data(),
                             i.accel_bias.data(), poses[j.camera].data(), j.velocity.data(),
                             j.accel_bias.data());
  }
  for (BundleMotionState& state : motion.states) {
    ordering.AddElementToGroup(poses[state.camera].data(), 1);
    ordering.AddElementToGroup(state.velocity.data(), 1);
    ordering.AddElementToGroup(state.accel_bias.data(), 1);
    if (!(state.accel_bias_sigma > 0)) continue;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CeresBiasPrior, 3, 3>(
                                 new CeresBiasPrior{state.accel_bias, state.accel_bias_sigma}),
                             nullptr, state.accel_bias.data());
  }
}

}  // namespace alidade
