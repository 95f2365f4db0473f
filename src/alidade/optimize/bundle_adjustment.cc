#include "alidade/optimize/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/base/error.h"
#include "alidade/optimize/bundle_linearise.h"
#include "alidade/optimize/bundle_schur.h"
#include "alidade/optimize/damping.h"

namespace alidade {
namespace {

// With larger damping a step is below the rounding error of the variables.
constexpr double kMaxLambda = 1e16;
constexpr double kMinLambda = 1e-12;

void Apply(const BundleLayout& layout, const BundleState& from, const BundleStep& step,
           BundleState& to) {
  to = from;
  for (size_t i = 0; i < layout.free_cameras.size(); ++i) {
    BundleCamera& camera = to.cameras[layout.free_cameras[i]];
    camera.R = camera.R * ExpSo3(step.cameras[i].tail<3>());
    camera.centre -= step.cameras[i].head<3>();
  }
  for (size_t j = 0; j < to.points.size(); ++j) to.points[j] += step.points[j];
  for (size_t k = 0; k < to.motion.size(); ++k) {
    to.motion[k].velocity += step.states[k].head<3>();
    to.motion[k].accel_bias += step.states[k].tail<3>();
  }
}

void Store(const BundleLayout& layout, const BundleState& state, BundleProblem& problem) {
  for (const int i : layout.free_cameras) {
    const BundleCamera& camera = state.cameras[i];
    Se3 T{camera.R, Eigen::Vector3d::Zero()};
    T = T.Normalised();
    T.t = -(T.R * camera.centre);
    problem.T_camera_world[i] = T;
  }
  for (size_t j = 0; j < layout.points.size(); ++j) {
    problem.points[layout.points[j].index] = state.points[j];
  }
  for (size_t k = 0; k < state.motion.size(); ++k) {
    problem.motion.states[k].velocity = state.motion[k].velocity;
    problem.motion.states[k].accel_bias = state.motion[k].accel_bias;
  }
}

}  // namespace

void BundleSettings::Check() const {
  if (max_iterations < 0) ThrowUsage("max_iterations: must not be negative");
  if (!(huber_mono > 0) || !std::isfinite(huber_mono)) ThrowUsage("huber_mono: must be above 0");
  if (!(huber_stereo > 0) || !std::isfinite(huber_stereo)) {
    ThrowUsage("huber_stereo: must be above 0");
  }
  if (!(min_relative_decrease >= 0) || min_relative_decrease >= 1) {
    ThrowUsage("min_relative_decrease: must be at least 0 and below 1");
  }
  if (!(initial_lambda > 0) || !std::isfinite(initial_lambda)) {
    ThrowUsage("initial_lambda: must be above 0");
  }
  if (sparse_above < 0) ThrowUsage("sparse_above: must not be negative");
}

BundleReport AdjustBundle(BundleProblem& problem, const BundleSettings& settings,
                          const std::atomic<bool>* stop) {
  settings.Check();
  const BundleLayout layout = LayOut(problem, settings);
  BundleReport report;
  if (layout.points.empty()) {
    report.converged = true;
    return report;
  }
  BundleState state = StartOf(problem, layout), trial;
  Linearisation system, next;
  Linearise(layout, nullptr, state, system);
  report.initial_cost = report.final_cost = system.cost;
  if (!system.valid) return report;

  const bool many = static_cast<int>(layout.free_cameras.size()) > settings.sparse_above;
  SchurSolver solver(layout, many ? ReducedFactor::kFastest : ReducedFactor::kDense);
  BundleStep step;
  Damping damping{settings.initial_lambda, kMinLambda};
  bool moved = false;
  while (report.iterations < settings.max_iterations && damping.lambda < kMaxLambda) {
    if (stop && *stop) break;
    ++report.iterations;
    solver.Solve(system, damping.lambda, step);
    if (!step.valid) {
      damping.Rejected();
      continue;
    }
    Apply(layout, state, step, trial);
    // A step that promises less than what ends the adjustment is most likely the last one, and then
    // only its cost is needed.
    const double least = settings.min_relative_decrease * system.cost;
    const bool derivatives = step.predicted >= least;
    Linearise(layout, &state, trial, next, derivatives);
    const double actual = system.cost - next.cost;
    const bool better = next.valid && actual > 0;
    report.converged = step.predicted <= 1e-14 * system.cost || (better && actual < least);
    if (better) {
      if (!derivatives && !report.converged) Linearise(layout, &state, trial, next);
      std::swap(state, trial);
      std::swap(system, next);
      damping.Accepted(actual, step.predicted);
      moved = true;
    } else {
      damping.Rejected();
    }
    if (report.converged) break;
  }
  report.converged |= damping.lambda >= kMaxLambda;
  report.final_cost = system.cost;
  if (moved) Store(layout, state, problem);
  return report;
}

double ChiSquared(const Camera& camera, const Se3& T_camera_world, const Eigen::Vector3d& p_world,
                  const BundleObservation& o) {
  const Intrinsics k = Intrinsics::Of(camera);
  const Eigen::Vector3d p = T_camera_world * p_world;
  if (!(p.z() > kMinDepth)) return std::numeric_limits<double>::infinity();
  const bool stereo = HasRight(k, o.pixel.z());
  const Reprojection<double> e =
      Reproject<double>(k, p.x(), p.y(), p.z(), o.pixel.x(), o.pixel.y(), stereo ? o.pixel.z() : 0);
  return o.inv_sigma2 * (e.u * e.u + e.v * e.v) + (stereo ? o.inv_sigma2_right * e.d * e.d : 0);
}

}  // namespace alidade
