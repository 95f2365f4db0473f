// Reference implementation of bundle adjustment with Ceres.
#pragma once

#include <memory>
#include <vector>

#include "alidade/optimize/bundle_adjustment.h"
#include "ceres_loss.h"
#include "ceres_motion.h"
#include "ceres_reprojection.h"

namespace alidade {

struct CeresBundleOptions {
  int max_iterations = 200;
  bool tight = true;  // to full precision; otherwise a fixed number of iterations, for timing
  ceres::LinearSolverType solver = ceres::DENSE_SCHUR;
};

// Improves `problem` in place. All observations must be finite and in front of their camera.
inline ceres::Solver::Summary AdjustWithCeres(BundleProblem& problem,
                                              const BundleSettings& settings,
                                              const CeresBundleOptions& with = {}) {
  std::vector<Eigen::Matrix<double, 6, 1>> poses;
  for (const Se3& T : problem.T_camera_world) poses.push_back(ToCeresPose(T));
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  const auto mono = CeresLoss(settings.huber_mono, settings.redescending);
  const auto stereo = CeresLoss(settings.huber_stereo, settings.redescending);
  std::vector<std::unique_ptr<ceres::LossFunction>> losses;  // one per observation
  ceres::Problem ceres_problem(ownership);
  auto* ordering = new ceres::ParameterBlockOrdering;
  for (const BundleObservation& o : problem.observations) {
    double* pose = poses[o.camera].data();
    double* point = problem.points[o.point].data();
    losses.push_back(
        std::make_unique<ceres::ScaledLoss>(std::isfinite(o.pixel.z()) ? stereo.get() : mono.get(),
                                            o.trust, ceres::DO_NOT_TAKE_OWNERSHIP));
    ceres_problem.AddResidualBlock(MakeCeresReprojection(problem.camera, o), losses.back().get(),
                                   pose, point);
    if (problem.fixed[o.camera]) ceres_problem.SetParameterBlockConstant(pose);
    ordering->AddElementToGroup(point, 0);
    ordering->AddElementToGroup(pose, 1);
  }
  AddCeresMotion(problem.motion, poses, ceres_problem, *ordering);
  ceres::Solver::Options options;
  options.linear_solver_type = with.solver;
  options.linear_solver_ordering.reset(ordering);
  options.num_threads = 1;
  options.max_num_iterations = with.max_iterations;
  options.function_tolerance = with.tight ? 1e-14 : 0;
  options.gradient_tolerance = with.tight ? 1e-12 : 0;
  options.parameter_tolerance = with.tight ? 1e-14 : 0;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  for (size_t i = 0; i < poses.size(); ++i) {
    if (!problem.fixed[i]) problem.T_camera_world[i] = FromCeresPose(poses[i]);
  }
  return summary;
}

}  // namespace alidade
