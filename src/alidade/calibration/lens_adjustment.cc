#include "alidade/calibration/lens_adjustment.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/median.h"
#include "alidade/base/parallel.h"
#include "alidade/calibration/lens_window.h"

namespace alidade {
namespace {

constexpr int kUnknowns = LensAdjustment::kParameters;

// Median of a residual's chi² with 2 degrees of freedom: 2 ln 2.
constexpr double kMedianChi2 = 1.3862943611198906;
constexpr size_t kLeastClusters = 3;  // windows needed for the sandwich estimator
// Relative to the diagonal; also added before inverting for the covariance.
constexpr double kGaugeDamping = 1e-8;

RadialLens Moved(RadialLens lens, const LensVector& step) {
  lens.focal *= std::exp(step.x());
  lens.k1 += step.y();
  lens.k2 += step.z();
  lens.centre += step.segment<2>(3);
  lens.readout += step.tail<2>();
  return lens;
}

double CostOf(const std::vector<LensWindow>& windows, const RadialLens& lens,
              const LensLoss& loss) {
  std::vector<double> costs(windows.size());
  ParallelFor(static_cast<int>(windows.size()), [&](int i) {
    double& cost = costs[static_cast<size_t>(i)];
    const double most = 0.5 * loss.noise * loss.noise * loss.bound * loss.bound;
    for (double chi2 : ChiSquaredOf(windows[static_cast<size_t>(i)], lens))
      cost += std::isfinite(chi2) ? loss.Cost(chi2) : most;
  });
  double sum = 0;
  for (double cost : costs) sum += cost;
  return sum;
}

double NoiseOf(const std::vector<LensWindow>& windows, const RadialLens& lens) {
  std::vector<double> all;
  for (const LensWindow& window : windows) {
    for (double chi2 : ChiSquaredOf(window, lens)) {
      if (std::isfinite(chi2)) all.push_back(chi2);
    }
  }
  return all.empty() ? 1 : std::max(1e-3, std::sqrt(UpperMedian(all) / kMedianChi2));
}

// Prior of the lens parameters as normal equations.
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
  // J'WJ and J'Wr of the lens with all else eliminated. Identity rows replace fixed parameters.
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
    // Limit the step of the lens to the range where the linearization holds.
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
    // Scaled as a whole, so that it remains a valid covariance.
    for (int k = 0; k < kUnknowns; ++k) {
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
