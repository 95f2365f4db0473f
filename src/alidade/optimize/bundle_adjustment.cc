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

BundleState StartOf(const BundleProblem& problem, const BundleLayout& layout) {
  BundleState state;
  state.cameras.reserve(problem.T_camera_world.size());
  for (const Se3& T : problem.T_camera_world) state.cameras.push_back({T.R, T.Inverse().t});
  state.points.reserve(layout.points.size());
  for (const BundlePoint& p : layout.points) state.points.push_back(problem.points[p.index]);
  state.motion = problem.motion.states;
  return state;
}

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

std::optional<Matrix6d> CameraCovariance(const BundleProblem& problem,
                                         const BundleSettings& settings, int camera) {
  const BundleLayout layout = LayOut(problem, settings);
  const auto at = std::find(layout.free_cameras.begin(), layout.free_cameras.end(), camera);
  if (at == layout.free_cameras.end()) return {};
  BundleState state = StartOf(problem, layout);
  Linearisation system;
  Linearise(layout, nullptr, state, system);
  if (!system.valid) return {};

  const auto cameras = static_cast<Eigen::Index>(layout.free_cameras.size());
  double measured = 0;
  bool has_right = false;
  for (const BundleSighting& sighting : layout.sightings) {
    has_right = has_right || sighting.weight_r > 0;
    measured += sighting.weight_r > 0 ? 3 : 2;
  }
  const BundleMotion& motion = problem.motion;
  for (const BundleMotionState& of_imu : motion.states)
    measured += of_imu.accel_bias_sigma > 0 ? 3 : 0;
  measured += 12.0 * static_cast<double>(motion.links.size());
  const double spare =
      measured - 6.0 * layout.rows() - 3.0 * static_cast<double>(layout.points.size());
  if (!(spare > 0)) return {};

  Eigen::VectorXd scale;
  const auto is_fixed = [](uint8_t fixed) { return fixed != 0; };
  if (!has_right && motion.links.empty() &&
      std::count_if(problem.fixed.begin(), problem.fixed.end(), is_fixed) == 1) {
    const auto fixed = std::find_if(problem.fixed.begin(), problem.fixed.end(), is_fixed);
    const Eigen::Vector3d& origin = state.cameras[fixed - problem.fixed.begin()].centre;
    scale = Eigen::VectorXd::Zero(6 * cameras);
    for (Eigen::Index i = 0; i < cameras; ++i)
      scale.segment<3>(6 * i) = state.cameras[layout.free_cameras[i]].centre - origin;
  }
  SchurSolver solver(layout, ReducedFactor::kDense);
  Matrix6d of_step;
  if (!solver.Covariance(system, static_cast<int>(at - layout.free_cameras.begin()), scale,
                         of_step))
    return {};
  // A step (ρ, θ) in world axes is xi = -(R ρ; R θ).
  const Eigen::Matrix3d& R = state.cameras[camera].R;
  Matrix6d covariance;
  for (int i = 0; i < 6; i += 3) {
    for (int j = 0; j < 6; j += 3)
      covariance.block<3, 3>(i, j) = R * of_step.block<3, 3>(i, j) * R.transpose();
  }
  covariance *= 2 * system.cost / spare;
  return 0.5 * (covariance + covariance.transpose());
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
