#include "alidade/optimize/bundle_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "alidade/optimize/bundle_linearise.h"
#include "alidade/optimize/bundle_schur.h"

namespace alidade {
namespace {

using Gauge = Eigen::Matrix<double, 6, 7>;  // step of a camera by a similarity of the world

bool HasRightImages(const BundleLayout& layout) {
  return std::any_of(layout.sightings.begin(), layout.sightings.end(),
                     [](const BundleSighting& sighting) { return sighting.weight_r > 0; });
}

// Of the residuals, relative to the assumed noise; nullopt: nothing is spare to tell it.
std::optional<double> VarianceFactor(const BundleLayout& layout, const BundleMotion& motion,
                                     double cost) {
  double measured = 12.0 * static_cast<double>(motion.links.size());
  for (const BundleSighting& sighting : layout.sightings) measured += sighting.weight_r > 0 ? 3 : 2;
  for (const BundleMotionState& of_imu : motion.states)
    measured += of_imu.accel_bias_sigma > 0 ? 3 : 0;
  const double spare =
      measured - 6.0 * layout.rows() - 3.0 * static_cast<double>(layout.points.size());
  if (!(spare > 0)) return {};
  return 2 * cost / spare;
}

// A step (ρ, θ) in world axes is xi = -(R ρ; R θ).
Matrix6d OfPose(const Matrix6d& of_step, const Eigen::Matrix3d& R) {
  Matrix6d covariance;
  for (int i = 0; i < 6; i += 3) {
    for (int j = 0; j < 6; j += 3)
      covariance.block<3, 3>(i, j) = R * of_step.block<3, 3>(i, j) * R.transpose();
  }
  return 0.5 * (covariance + covariance.transpose());
}

// Steps by which nothing that is observed changes: the world shifts, turns about the mean of the
// cameras (radians × `length`), and grows (also × `length`).
std::vector<Gauge> GaugeOf(const BundleState& state, const BundleLayout& layout, double length) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const int i : layout.free_cameras) mean += state.cameras[i].centre;
  mean /= static_cast<double>(layout.free_cameras.size());
  std::vector<Gauge> gauge;
  gauge.reserve(layout.free_cameras.size());
  for (const int i : layout.free_cameras) {
    const Eigen::Vector3d c = (state.cameras[i].centre - mean) / length;
    Gauge& G = gauge.emplace_back(Gauge::Zero());
    G.topLeftCorner<3, 3>().setIdentity();
    G.block<3, 3>(0, 3) = Skew(c);
    G.block<3, 3>(3, 3) = -Eigen::Matrix3d::Identity() / length;
    G.topRightCorner<3, 1>() = -c;
  }
  return gauge;
}

// Which numbers of the step are held so that the others are determined: the step of the camera
// nearest to the middle, and for the scale the largest coordinate of the one farthest from it.
std::vector<int> HeldRows(const std::vector<Gauge>& gauge, bool similar) {
  const auto from_middle = [](const Gauge& a, const Gauge& b) {
    return a.col(6).squaredNorm() < b.col(6).squaredNorm();
  };
  const auto middle = std::min_element(gauge.begin(), gauge.end(), from_middle) - gauge.begin();
  std::vector<int> held;
  for (int i = 0; i < 6; ++i) held.push_back(6 * static_cast<int>(middle) + i);
  if (!similar) return held;
  const auto distance = [&](const Gauge& a) { return (a - gauge[middle]).col(6).squaredNorm(); };
  const auto far =
      std::max_element(gauge.begin(), gauge.end(),
                       [&](const Gauge& a, const Gauge& b) { return distance(a) < distance(b); }) -
      gauge.begin();
  int largest = 0;
  (gauge[far] - gauge[middle]).col(6).head<3>().cwiseAbs().maxCoeff(&largest);
  held.push_back(6 * static_cast<int>(far) + largest);
  return held;
}

// Of the steps x, what remains after the alignment: x_i - G_i M' x with M = W G (G' W G)⁻¹. Its
// covariance is C_ii - Y_i G_i' - G_i Y_i' + G_i M' Y G_i' with Y = C M.
class Alignment {
 public:
  Alignment(const std::vector<Gauge>& gauge, const SchurSolver& solver, bool similar, double length)
      : gauge_(gauge) {
    const Eigen::Index columns = similar ? 7 : 6;
    const auto rows = static_cast<Eigen::Index>(6 * gauge.size());
    Vector6d weight = Vector6d::Ones();
    weight.tail<3>().setConstant(length * length);
    Eigen::MatrixXd M(rows, 7), normal = Eigen::MatrixXd::Zero(7, 7);
    for (size_t i = 0; i < gauge.size(); ++i) {
      M.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = weight.asDiagonal() * gauge[i];
      normal += gauge[i].transpose() * weight.asDiagonal() * gauge[i];
    }
    const Eigen::MatrixXd inverse = normal.topLeftCorner(columns, columns).inverse();
    M.leftCols(columns) = (M.leftCols(columns) * inverse).eval();
    M.rightCols(7 - columns).setZero();
    Y_ = M;
    for (Eigen::Index j = 0; j < columns; ++j) {
      Eigen::VectorXd column = M.col(j);
      solver.SolveFactored(column);
      Y_.col(j) = column;
    }
    common_ = M.transpose() * Y_;
  }

  // `covariance`: of the step of camera `i`.
  Matrix6d Of(const Matrix6d& covariance, size_t i) const {
    const Gauge& G = gauge_[i];
    const Gauge Y = Y_.middleRows<6>(6 * static_cast<Eigen::Index>(i));
    return covariance - Y * G.transpose() - G * Y.transpose() + G * common_ * G.transpose();
  }

 private:
  const std::vector<Gauge>& gauge_;
  Eigen::Matrix<double, Eigen::Dynamic, 7> Y_;
  Eigen::Matrix<double, 7, 7> common_;
};

}  // namespace

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
  const BundleMotion& motion = problem.motion;
  const std::optional<double> factor = VarianceFactor(layout, motion, system.cost);
  if (!factor) return {};

  Eigen::VectorXd scale;
  const auto is_fixed = [](uint8_t fixed) { return fixed != 0; };
  if (!HasRightImages(layout) && motion.links.empty() &&
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
  return *factor * OfPose(of_step, state.cameras[camera].R);
}

std::vector<Matrix6d> CameraCovariances(const BundleProblem& problem,
                                        const BundleSettings& settings, double length,
                                        double most_work) {
  std::vector<Matrix6d> result(problem.T_camera_world.size(), Matrix6d::Zero());
  const BundleLayout layout = LayOut(problem, settings);
  BundleState state = StartOf(problem, layout);
  Linearisation system;
  Linearise(layout, nullptr, state, system);
  const std::optional<double> factor =
      system.valid ? VarianceFactor(layout, problem.motion, system.cost) : std::nullopt;
  if (!factor || layout.free_cameras.size() < 2) return result;

  const bool similar = !HasRightImages(layout);
  const double variance = similar ? *factor : std::max(*factor, 1.0);
  const std::vector<Gauge> gauge = GaugeOf(state, layout, length);
  SchurSolver solver(layout, ReducedFactor::kFastest);
  if (solver.Work() > most_work) return {};
  if (!solver.Factor(system, HeldRows(gauge, similar))) return result;
  const Alignment align(gauge, solver, similar, length);
  const std::vector<Matrix6d> of_steps = solver.InverseDiagonal();
  for (size_t i = 0; i < of_steps.size(); ++i) {
    const int camera = layout.free_cameras[i];
    const Matrix6d covariance = variance * align.Of(of_steps[i], i);
    if (covariance.allFinite()) result[camera] = OfPose(covariance, state.cameras[camera].R);
  }
  return result;
}

}  // namespace alidade
