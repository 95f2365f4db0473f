#include "alidade/optimize/sim3_refine.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/optimize/reprojection.h"

namespace alidade {
namespace {

struct NormalEquations {
  Matrix7d H = Matrix7d::Zero();
  Vector7d g = Vector7d::Zero();
  double cost = 0;
};

// Residual of one match in one image.
struct Seen {
  Eigen::Vector3d p;  // point of the other camera, in this camera's frame
  Eigen::Vector2d r;  // in standard deviations
  double chi2;        // infinity behind the camera
};

Seen Look(const Camera& camera, const Sim3& T, const Eigen::Vector3d& p_other,
          const Eigen::Vector2d& pixel, double sigma) {
  Seen seen;
  seen.p = T * p_other;
  if (!(seen.p.z() > kMinDepth)) return {seen.p, Eigen::Vector2d::Zero(), INFINITY};
  seen.r = (camera.Project(seen.p) - pixel) / sigma;
  seen.chi2 = seen.r.squaredNorm();
  return seen;
}

// Cap on chi²: the loss is constant beyond it and behind the camera, as in pose_only.cc.
double FarChi2(const Camera& camera, double sigma) {
  return 16 * camera.fx * camera.fx / (sigma * sigma);
}

// Adds one image's residual; D is the derivative of its point by the increment.
void Add(const Camera& camera, const Seen& seen, double sigma, double huber,
         const Eigen::Matrix<double, 3, 7>& D, NormalEquations& n) {
  const double far = FarChi2(camera, sigma), root = std::sqrt(std::min(seen.chi2, far));
  const double inner = std::min(root, huber);
  n.cost += inner * (root - 0.5 * inner);  // half of the Huber loss
  if (!(seen.chi2 < far)) return;
  const double weight = root > huber ? huber / root : 1;
  const double inv_z = 1 / seen.p.z(), u_x = camera.fx * inv_z, v_y = camera.fy * inv_z;
  Eigen::Matrix<double, 2, 3> A;
  A << u_x, 0, -u_x * seen.p.x() * inv_z, 0, v_y, -v_y * seen.p.y() * inv_z;
  const Eigen::Matrix<double, 2, 7> J = (A * D) / sigma;
  n.H += weight * (J.transpose() * J);
  n.g += weight * (J.transpose() * seen.r);
}

class Refiner {
 public:
  Refiner(const Camera& camera, std::span<const Sim3Match> matches, bool with_scale, double huber)
      : camera_(camera), matches_(matches), with_scale_(with_scale), huber_(huber) {
    for (const Sim3Match& m : matches) {
      const bool usable = m.p_a.allFinite() && m.p_b.allFinite() && m.pixel_a.allFinite() &&
                          m.pixel_b.allFinite() && m.sigma_a > 0 && std::isfinite(m.sigma_a) &&
                          m.sigma_b > 0 && std::isfinite(m.sigma_b);
      usable_.push_back(usable);
    }
    UseAll();
  }

  const std::vector<bool>& active() const { return active_; }
  void UseAll() { active_ = usable_; }

  // A point in a moves by (I, -[p]x, p) δ for T_a_b <- Exp(δ) T_a_b; a point in b, where T_b_a <-
  // T_b_a Exp(-δ), moves by -Rᵀ/s (I, -[p_a]x, p_a) δ.
  NormalEquations Linearise(const Sim3& T_a_b, bool robust) const {
    NormalEquations n;
    const Sim3 T_b_a = T_a_b.Inverse();
    const Eigen::Matrix3d back = -T_b_a.s * T_b_a.R;
    const double huber = robust ? huber_ : INFINITY;
    Eigen::Matrix<double, 3, 7> D;
    for (size_t i = 0; i < matches_.size(); ++i) {
      if (!active_[i]) continue;
      const Sim3Match& m = matches_[i];
      const Seen a = Look(camera_, T_a_b, m.p_b, m.pixel_a, m.sigma_a);
      const Seen b = Look(camera_, T_b_a, m.p_a, m.pixel_b, m.sigma_b);
      D << Eigen::Matrix3d::Identity(), -Skew(a.p), a.p;
      Add(camera_, a, m.sigma_a, huber, D, n);
      D << back, -back * Skew(m.p_a), back * m.p_a;
      Add(camera_, b, m.sigma_b, huber, D, n);
    }
    if (!with_scale_) {
      n.H.row(6).setZero();
      n.H.col(6).setZero();
      n.g[6] = 0;
    }
    return n;
  }

  // Updates the inlier flags by the gate in both images. Returns true if any changed.
  bool Reclassify(const Sim3& T_a_b, int& inliers) {
    const Sim3 T_b_a = T_a_b.Inverse();
    bool changed = false;
    inliers = 0;
    for (size_t i = 0; i < matches_.size(); ++i) {
      if (!usable_[i]) continue;
      const Sim3Match& m = matches_[i];
      const bool inlier =
          Look(camera_, T_a_b, m.p_b, m.pixel_a, m.sigma_a).chi2 <= huber_ * huber_ &&
          Look(camera_, T_b_a, m.p_a, m.pixel_b, m.sigma_b).chi2 <= huber_ * huber_;
      changed |= inlier != active_[i];
      active_[i] = inlier;
      inliers += inlier;
    }
    return changed;
  }

 private:
  const Camera& camera_;
  std::span<const Sim3Match> matches_;
  bool with_scale_;
  double huber_;
  std::vector<bool> usable_, active_;
};

// Levenberg–Marquardt with minimal damping: Gauss–Newton while the cost falls. Ends when the
// predicted gain is less than `tolerance` of the cost.
NormalEquations Descend(const Refiner& refiner, bool robust, int max_iterations, double tolerance,
                        Sim3& T) {
  NormalEquations at = refiner.Linearise(T, robust);
  double lambda = 1e-9;
  for (int i = 0; i < max_iterations; ++i) {
    Matrix7d damped = at.H;
    const double largest = damped.diagonal().maxCoeff();
    damped.diagonal() += lambda * at.H.diagonal();
    damped.diagonal().array() += 1e-12 * largest + 1e-300;
    const Vector7d step = -damped.llt().solve(at.g);
    const double gain = -0.5 * at.g.dot(step);
    if (!step.allFinite() || !(gain >= 0)) break;
    const Sim3 trial = ExpSim3(step) * T;
    const NormalEquations next = refiner.Linearise(trial, robust);
    const bool last = gain < tolerance * at.cost + 1e-12;
    if (next.cost < at.cost) {
      T = trial;
      at = next;
      lambda = std::max(lambda * 0.1, 1e-9);
    } else {
      lambda = std::max(lambda * 10, 1e-3);
    }
    if (last) break;
  }
  return at;
}

}  // namespace

void Sim3RefineSettings::Check() const {
  if (max_iterations < 1) ThrowUsage("max_iterations: must be at least 1");
  if (rounds < 1) ThrowUsage("rounds: must be at least 1");
  if (!(huber > 0) || !std::isfinite(huber)) ThrowUsage("huber: must be above 0");
}

Sim3RefineResult RefineSim3(const Camera& camera, const Sim3& T_a_b,
                            std::span<const Sim3Match> matches, bool with_scale,
                            const Sim3RefineSettings& settings) {
  settings.Check();
  Sim3RefineResult result;
  result.T_a_b = T_a_b;
  if (!with_scale) result.T_a_b.s = 1;
  result.inlier.assign(matches.size(), false);
  Refiner refiner(camera, matches, with_scale, settings.huber);
  if (std::count(refiner.active().begin(), refiner.active().end(), true) < 3) return result;

  // Before the inliers are final, an accuracy of a fraction of the standard deviation suffices.
  Sim3 T = result.T_a_b;
  for (int round = 0; round < settings.rounds; ++round) {
    Descend(refiner, true, settings.max_iterations, 1e-3, T);
    if (!refiner.Reclassify(T, result.inliers)) break;
    if (result.inliers < 3 && round + 1 < settings.rounds) refiner.UseAll();
  }
  if (result.inliers < 3) {
    result.inliers = 0;
    return result;
  }
  const NormalEquations last = Descend(refiner, false, settings.max_iterations, 1e-7, T);
  result.T_a_b = T;
  result.T_a_b.R = Eigen::Quaterniond(T.R).normalized().toRotationMatrix();
  result.inlier = refiner.active();
  result.information = last.H;
  result.cost = last.cost;
  return result;
}

}  // namespace alidade
