#include "alidade/optimize/lens_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/median.h"
#include "alidade/base/parallel.h"
#include "alidade/optimize/reprojection.h"

namespace alidade {
namespace {

constexpr int kUnknowns = LensAdjustment::kParameters;
using ByLens = Eigen::Matrix<double, 2, kUnknowns>;
using LensMatrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using LensVector = LensAdjustment::Parameters;

// Of a residual's chi²: with 2 degrees of freedom its median is 2 ln 2.
constexpr double kMedianChi2 = 1.3862943611198906;
constexpr size_t kLeastClusters = 3;    // windows whose differences say how far they are off
constexpr double kGaugeDamping = 1e-8;  // of the diagonal; of a covariance, too
constexpr double kLeastSlope = 0.1;     // of seen radius by ideal radius: beyond, a lens folds over

struct LensRow {
  int camera = -1;
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 6> by_camera;  // translation, rotation: left-multiplied
  Eigen::Matrix<double, 2, 3> by_point;
  ByLens by_lens;
  double weight = 0;
};

// Of one observation in pixels; false behind the camera or where the lens has no picture.
bool Residual(const RadialLens& lens, const Eigen::Vector3d& p, const Eigen::Vector2d& seen,
              Eigen::Vector2d& residual) {
  if (!(p.z() > kMinDepth)) return false;
  const Eigen::Vector2d ideal = p.head<2>() / p.z();
  const double r2 = ideal.squaredNorm();
  if (!(1 + r2 * (3 * lens.k1 + 5 * r2 * lens.k2) > kLeastSlope)) return false;
  residual = lens.centre + lens.focal * (1 + r2 * (lens.k1 + r2 * lens.k2)) * ideal - seen;
  return true;
}

// From the camera at the image's middle to where it was when the observation's row was read.
Se3 WhenRead(const RadialLens& lens, const LensWindow& window, const LensObservation& o) {
  if (window.motions.empty() || lens.readout.isZero(0)) return {};
  return Se3::Exp(lens.readout.dot(o.read) * window.motions[static_cast<size_t>(o.camera)]);
}

bool LineariseLens(const RadialLens& lens, const LensWindow& window, const LensObservation& o,
                   LensRow& row) {
  const Se3& T_camera_world = window.T_camera_world[static_cast<size_t>(o.camera)];
  const Se3 T_read_camera = WhenRead(lens, window, o);
  const Eigen::Vector3d at_middle = T_camera_world * window.points[static_cast<size_t>(o.point)];
  const Eigen::Vector3d p = T_read_camera * at_middle;
  if (!Residual(lens, p, o.pixel, row.residual)) return false;
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double d = 1 + r2 * (lens.k1 + r2 * lens.k2), slope = lens.k1 + 2 * r2 * lens.k2;
  Eigen::Matrix2d by_ideal;
  by_ideal << d + 2 * x * x * slope, 2 * x * y * slope, 2 * x * y * slope, d + 2 * y * y * slope;
  Eigen::Matrix<double, 2, 3> of_point;  // ideal by p
  of_point << 1 / p.z(), 0, -x / p.z(), 0, 1 / p.z(), -y / p.z();
  const Eigen::Matrix<double, 2, 3> by_p = lens.focal * by_ideal * of_point;
  const auto cross = [](const Eigen::Vector3d& v) {
    return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
  };
  const Eigen::Matrix<double, 2, 3> by_middle = by_p * T_read_camera.R;
  row.by_camera << by_middle, -by_middle * cross(at_middle);
  row.by_point = by_middle * T_camera_world.R;
  const Eigen::Vector2d ideal(x, y);
  row.by_lens << lens.focal * d * ideal, lens.focal * r2 * ideal, lens.focal * r2 * r2 * ideal,
      Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Zero();
  if (!window.motions.empty()) {
    // d Exp(s v) p / ds = v.head + v.tail × p, and s = readout · read.
    const Vector6d& v = window.motions[static_cast<size_t>(o.camera)];
    const Eigen::Vector2d flow = by_p * (v.head<3>() + v.tail<3>().cross(p));
    row.by_lens.rightCols<2>() = flow * o.read.transpose();
  }
  return true;
}

RadialLens Moved(RadialLens lens, const LensVector& step) {
  lens.focal *= std::exp(step.x());
  lens.k1 += step.y();
  lens.k2 += step.z();
  lens.centre += step.segment<2>(3);
  lens.readout += step.tail<2>();
  return lens;
}

// Normal equations of one window at one place, points eliminated.
struct WindowSystem {
  Eigen::MatrixXd H;             // poses, lower triangle
  Eigen::MatrixXd lens_by_pose;  // lens × poses
  Eigen::VectorXd g;             // of the poses: J' W r
  LensMatrix lens = LensMatrix::Zero();
  LensVector g_lens = LensVector::Zero();
  int observations = 0;
  // What eliminating left of each point, to find its step from those of poses and lens.
  struct Point {
    Eigen::Matrix3d inverse;
    Eigen::Vector3d g;
    Eigen::Matrix<double, kUnknowns, 3> by_lens;  // lens × point
    std::vector<std::pair<int, Eigen::Matrix<double, 6, 3>>> by_camera;
  };
  std::vector<Point> points;  // one for each of the window's; empty by_camera: it stays
};

struct LensLoss {
  double noise = 1, bound = 3;
  // chi2 in units of the assumed variance.
  double Weight(double chi2) const {
    const double q = chi2 / (noise * noise * bound * bound);
    return 1 / ((1 + q) * (1 + q));
  }
  double Cost(double chi2) const {
    return 0.5 * chi2 / (1 + chi2 / (noise * noise * bound * bound));
  }
};

void EliminatePoint(const std::vector<LensRow>& rows, double damping, WindowSystem& system,
                    WindowSystem::Point& point) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  point.g.setZero();
  point.by_lens.setZero();
  for (const LensRow& row : rows) {
    H += row.weight * row.by_point.transpose() * row.by_point;
    point.g += row.weight * row.by_point.transpose() * row.residual;
    point.by_lens += row.weight * row.by_lens.transpose() * row.by_point;
    point.by_camera.emplace_back(row.camera, row.weight * row.by_camera.transpose() * row.by_point);
  }
  H.diagonal() *= 1 + damping;
  point.inverse = H.inverse();
  if (!point.inverse.allFinite()) {
    point.by_camera.clear();
    return;
  }
  for (const LensRow& row : rows) {
    const Eigen::Index c = 6 * row.camera;
    system.H.block<6, 6>(c, c) += row.weight * row.by_camera.transpose() * row.by_camera;
    system.lens_by_pose.block<kUnknowns, 6>(0, c) +=
        row.weight * row.by_lens.transpose() * row.by_camera;
    system.lens += row.weight * row.by_lens.transpose() * row.by_lens;
    system.g.segment<6>(c) += row.weight * row.by_camera.transpose() * row.residual;
    system.g_lens += row.weight * row.by_lens.transpose() * row.residual;
  }
  system.observations += static_cast<int>(rows.size());
  for (const auto& [i, Hi] : point.by_camera) {
    const Eigen::Matrix<double, 6, 3> A = Hi * point.inverse;
    system.g.segment<6>(6 * i) -= A * point.g;
    system.lens_by_pose.block<kUnknowns, 6>(0, 6 * i) -= point.by_lens * A.transpose();
    for (const auto& [j, Hj] : point.by_camera) {
      if (j <= i) system.H.block<6, 6>(6 * i, 6 * j) -= A * Hj.transpose();
    }
  }
  system.lens -= point.by_lens * point.inverse * point.by_lens.transpose();
  system.g_lens -= point.by_lens * point.inverse * point.g;
}

WindowSystem SystemOf(const LensWindow& window, const RadialLens& lens, const LensLoss& loss,
                      double damping) {
  const auto size = 6 * static_cast<Eigen::Index>(window.T_camera_world.size());
  WindowSystem system;
  system.H = Eigen::MatrixXd::Zero(size, size);
  system.lens_by_pose = Eigen::MatrixXd::Zero(kUnknowns, size);
  system.g = Eigen::VectorXd::Zero(size);
  system.points.resize(window.points.size());
  std::vector<LensRow> rows;
  const auto& all = window.observations;
  for (size_t i = 0; i < all.size(); ++i) {
    const LensObservation& o = all[i];
    LensRow row;
    row.camera = o.camera;
    if (LineariseLens(lens, window, o, row)) {
      row.weight = o.inv_sigma2 * loss.Weight(o.inv_sigma2 * row.residual.squaredNorm());
      rows.push_back(row);
    }
    if (i + 1 < all.size() && all[i + 1].point == o.point) continue;
    if (rows.size() >= 2)
      EliminatePoint(rows, damping, system, system.points[static_cast<size_t>(o.point)]);
    rows.clear();
  }
  return system;
}

// The poses eliminated, too: what the window says of the lens alone.
struct LensSystem {
  Eigen::LDLT<Eigen::MatrixXd> poses;
  LensMatrix H;
  LensVector g;
};

LensSystem LensAlone(const WindowSystem& system, double damping) {
  LensSystem alone;
  Eigen::MatrixXd H = system.H;
  // A pose that nothing was seen from stays; the others keep their gauge.
  const double least = 1e-12 * std::max(1.0, H.diagonal().maxCoeff());
  H.diagonal() = (H.diagonal() * (1 + damping)).cwiseMax(least);
  alone.poses.compute(H);  // of the lower triangle
  alone.H = system.lens - system.lens_by_pose * alone.poses.solve(system.lens_by_pose.transpose());
  alone.g = system.g_lens - system.lens_by_pose * alone.poses.solve(system.g);
  return alone;
}

void MoveWindow(const WindowSystem& system, const LensSystem& alone, const LensVector& lens_step,
                LensWindow& window) {
  const Eigen::VectorXd step =
      -alone.poses.solve(system.g + system.lens_by_pose.transpose() * lens_step);
  for (size_t i = 0; i < window.T_camera_world.size(); ++i) {
    Se3& T = window.T_camera_world[i];
    T = Se3::Exp(step.segment<6>(6 * static_cast<Eigen::Index>(i))) * T;
  }
  for (size_t i = 0; i < window.points.size(); ++i) {
    const WindowSystem::Point& point = system.points[i];
    if (point.by_camera.empty()) continue;
    Eigen::Vector3d right = point.g + point.by_lens.transpose() * lens_step;
    for (const auto& [camera, H] : point.by_camera)
      right += H.transpose() * step.segment<6>(6 * camera);
    window.points[i] -= point.inverse * right;
  }
}

void ForEachChi2(const LensWindow& window, const RadialLens& lens, auto&& visit) {
  for (const LensObservation& o : window.observations) {
    Eigen::Vector2d residual;
    const Eigen::Vector3d p =
        WhenRead(lens, window, o) * (window.T_camera_world[static_cast<size_t>(o.camera)] *
                                     window.points[static_cast<size_t>(o.point)]);
    const bool seen = Residual(lens, p, o.pixel, residual);
    visit(seen ? o.inv_sigma2 * residual.squaredNorm() : std::numeric_limits<double>::infinity());
  }
}

double CostOf(const std::vector<LensWindow>& windows, const RadialLens& lens,
              const LensLoss& loss) {
  std::vector<double> costs(windows.size());
  ParallelFor(static_cast<int>(windows.size()), [&](int i) {
    double& cost = costs[static_cast<size_t>(i)];
    const double most = 0.5 * loss.noise * loss.noise * loss.bound * loss.bound;
    ForEachChi2(windows[static_cast<size_t>(i)], lens,
                [&](double chi2) { cost += std::isfinite(chi2) ? loss.Cost(chi2) : most; });
  });
  double sum = 0;
  for (double cost : costs) sum += cost;
  return sum;
}

double NoiseOf(const std::vector<LensWindow>& windows, const RadialLens& lens) {
  std::vector<double> all;
  for (const LensWindow& window : windows) {
    ForEachChi2(window, lens, [&](double chi2) {
      if (std::isfinite(chi2)) all.push_back(chi2);
    });
  }
  return all.empty() ? 1 : std::max(1e-3, std::sqrt(UpperMedian(all) / kMedianChi2));
}

// Where the lens is believed to be beforehand, as equations.
struct LensPrior {
  RadialLens start;
  Eigen::Vector2d centre;
  LensVector information = LensVector::Zero();

  LensPrior(const RadialLens& at, const LensAdjustmentSettings& s)
      : start(at), centre(s.centre.value_or(at.centre)) {
    const auto of = [](double sigma) { return sigma > 0 ? 1 / (sigma * sigma) : 0.0; };
    information << of(s.focal_sigma), of(s.k1_sigma), of(s.k2_sigma), of(s.centre_sigma),
        of(s.centre_sigma), of(s.readout_sigma.x()), of(s.readout_sigma.y());
    if (s.hold_focal) information.x() = 0;
  }
  LensVector Off(const RadialLens& lens) const {
    LensVector off;
    off << std::log(lens.focal / start.focal), lens.k1, lens.k2, lens.centre - centre, lens.readout;
    return off;
  }
  double Cost(const RadialLens& lens, double noise2) const {
    return 0.5 * noise2 * Off(lens).cwiseAbs2().dot(information);
  }
};

void CheckIndices(const std::vector<LensWindow>& windows) {
  for (const LensWindow& window : windows) {
    const auto cameras = static_cast<int>(window.T_camera_world.size());
    const auto points = static_cast<int>(window.points.size());
    if (!window.motions.empty() && window.motions.size() != window.T_camera_world.size())
      ThrowUsage("AdjustLens: motions are not one for each camera");
    for (const LensObservation& o : window.observations) {
      if (o.camera < 0 || o.camera >= cameras || o.point < 0 || o.point >= points)
        ThrowUsage("AdjustLens: an observation names a camera or point that isn't there");
    }
  }
}

}  // namespace

void LensAdjustmentSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("lens adjustment: ") + what);
  };
  require(max_iterations >= 0, "max_iterations cannot be negative");
  require(min_relative_decrease >= 0 && min_lens_step >= 0, "bounds of steps cannot be negative");
  require(focal_sigma > 0, "focal_sigma must be positive");
  require(k1_sigma >= 0 && k2_sigma >= 0 && centre_sigma >= 0 && readout_sigma.minCoeff() >= 0,
          "*_sigma cannot be negative");
  require(inflation >= 1, "inflation must be at least 1");
  require(bound >= 1, "bound must be at least 1");
}

LensAdjustment AdjustLens(std::vector<LensWindow>& windows, const RadialLens& start,
                          const LensAdjustmentSettings& settings, const std::atomic<bool>* stop) {
  settings.Check();
  CheckIndices(windows);
  LensAdjustment result;
  result.lens = start;
  const LensPrior prior(start, settings);
  LensVector free;
  free << !settings.hold_focal, settings.k1_sigma > 0, settings.k2_sigma > 0,
      settings.centre_sigma > 0, settings.centre_sigma > 0, settings.readout_sigma.x() > 0,
      settings.readout_sigma.y() > 0;
  const int count = static_cast<int>(windows.size());
  std::vector<WindowSystem> systems(windows.size());
  std::vector<LensSystem> alone(windows.size());
  const double spread = settings.inflation * settings.inflation;
  // J'WJ of the lens, all else eliminated, and J'Wr; held parameters are left out by the identity.
  const auto gather = [&](const LensLoss& loss, double damping) {
    ParallelFor(count, [&](int i) {
      const auto at = static_cast<size_t>(i);
      systems[at] = SystemOf(windows[at], result.lens, loss, damping);
      alone[at] = LensAlone(systems[at], damping);
    });
    const double noise2 = spread * loss.noise * loss.noise;
    LensMatrix H = (noise2 * prior.information).asDiagonal();
    LensVector g = noise2 * prior.information.cwiseProduct(prior.Off(result.lens));
    for (const LensSystem& system : alone) {
      H += system.H;
      g += system.g;
    }
    for (int k = 0; k < kUnknowns; ++k) {
      if (free[k] != 0) continue;
      H.row(k).setZero();
      H.col(k).setZero();
      H(k, k) = 1;
      g[k] = 0;
    }
    return std::pair(H, g);
  };

  LensLoss loss{NoiseOf(windows, start), settings.bound};
  double damping = 1e-4;
  double cost = CostOf(windows, result.lens, loss) +
                prior.Cost(result.lens, spread * loss.noise * loss.noise);
  for (; result.iterations < settings.max_iterations && !(stop && *stop); ++result.iterations) {
    auto [H, g] = gather(loss, damping);
    H.diagonal() *= 1 + damping;
    LensVector step = -H.ldlt().solve(g);
    // A lens is not believed to leap: what is linear near by is not, far away.
    const double most = std::max({std::abs(step.x()) / 0.3, std::abs(step.y()) / 0.3,
                                  step.tail<2>().cwiseAbs().maxCoeff() / 0.02});
    if (!step.allFinite()) break;
    if (most > 1) step /= most;
    std::vector<LensWindow> moved = windows;
    for (size_t i = 0; i < windows.size(); ++i) MoveWindow(systems[i], alone[i], step, moved[i]);
    const RadialLens lens = Moved(result.lens, step);
    const double tried =
        CostOf(moved, lens, loss) + prior.Cost(lens, spread * loss.noise * loss.noise);
    if (!(tried < cost)) {
      damping *= 8;
      if (damping > 1e4) break;
      continue;
    }
    const bool done = cost - tried < settings.min_relative_decrease * cost &&
                      step.head<3>().cwiseAbs().maxCoeff() < settings.min_lens_step;
    windows = std::move(moved);
    result.lens = lens;
    damping = std::max(1e-7, damping / 4);
    loss.noise = NoiseOf(windows, lens);
    cost = CostOf(windows, lens, loss) + prior.Cost(lens, spread * loss.noise * loss.noise);
    if (done) {
      result.converged = true;
      ++result.iterations;
      break;
    }
  }

  const auto [H, g] = gather(loss, kGaugeDamping);
  for (const WindowSystem& system : systems) result.observations += system.observations;
  result.noise = loss.noise;
  const LensMatrix inverse = H.inverse();
  result.covariance = inverse * (spread * loss.noise * loss.noise);
  if (windows.size() >= kLeastClusters) {
    LensMatrix meat = LensMatrix::Zero();
    for (const LensSystem& system : alone) meat += system.g * system.g.transpose();
    const auto n = static_cast<double>(windows.size());
    const LensMatrix sandwich = inverse * (n / (n - 1) * meat) * inverse;
    for (int k = 0; k < kUnknowns; ++k) {  // scaled as a whole, so that it stays a covariance
      const double more = std::sqrt(std::max(1.0, sandwich(k, k) / result.covariance(k, k)));
      result.covariance.row(k) *= more;
      result.covariance.col(k) *= more;
    }
  }
  for (int k = 0; k < kUnknowns; ++k) {
    if (free[k] != 0) continue;
    result.covariance.row(k).setZero();
    result.covariance.col(k).setZero();
  }
  return result;
}

}  // namespace alidade
