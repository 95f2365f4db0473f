// Reference implementation of bundle adjustment with an inertial sensor: Ceres, with numeric
// derivatives of the inertial residuals.
#pragma once

#include <ceres/ceres.h>

#include <memory>
#include <vector>

#include "ceres_loss.h"
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

// Improves `problem` in place. All observations are of one camera each, finite and in front.
inline ceres::Solver::Summary AdjustMotionWithCeres(BundleProblem& problem,
                                                    const BundleSettings& settings) {
  std::vector<Vector6d> poses;
  for (const Se3& T : problem.T_camera_world) poses.push_back(ToCeresPose(T));
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  const auto mono = CeresLoss(settings.huber_mono, settings.redescending);
  const auto stereo = CeresLoss(settings.huber_stereo, settings.redescending);
  ceres::Problem ceres_problem(ownership);
  for (const BundleObservation& o : problem.observations) {
    ceres_problem.AddResidualBlock(MakeCeresReprojection(problem.camera, o),
                                   std::isfinite(o.pixel.z()) ? stereo.get() : mono.get(),
                                   poses[o.camera].data(), problem.points[o.point].data());
  }
  BundleMotion& motion = problem.motion;
  for (const BundleMotionLink& link : motion.links) {
    const Matrix9d information = link.covariance.inverse();
    auto* cost =
        new ceres::NumericDiffCostFunction<CeresMotion, ceres::RIDDERS, 12, 6, 3, 3, 6, 3, 3>(
            new CeresMotion{&motion, &link, Matrix9d(information.llt().matrixU())});
    BundleMotionState &i = motion.states[link.from], &j = motion.states[link.to];
    ceres_problem.AddResidualBlock(cost, nullptr, poses[i.camera].data(), i.velocity.data(),
                                   i.accel_bias.data(), poses[j.camera].data(), j.velocity.data(),
                                   j.accel_bias.data());
  }
  for (BundleMotionState& state : motion.states) {
    if (!(state.accel_bias_sigma > 0)) continue;
    ceres_problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<CeresBiasPrior, 3, 3>(
            new CeresBiasPrior{state.accel_bias, state.accel_bias_sigma}),
        nullptr, state.accel_bias.data());
  }
  for (size_t i = 0; i < poses.size(); ++i) {
    if (problem.fixed[i]) ceres_problem.SetParameterBlockConstant(poses[i].data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.num_threads = 1;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  for (size_t i = 0; i < poses.size(); ++i) {
    if (!problem.fixed[i]) problem.T_camera_world[i] = FromCeresPose(poses[i]);
  }
  return summary;
}

}  // namespace alidade
