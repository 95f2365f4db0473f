#include "alidade/geometry/turned_lens.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/geometry/two_view_ransac.h"

namespace alidade {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

struct Turn {
  Eigen::Matrix3d R;
  LensChange lens;

  Turn Stepped(const Vector5d& step, double uncertainty) const {
    Turn next;
    next.R = ExpSo3(step.head<3>()) * R;
    next.lens.g = std::clamp(lens.g * std::exp(step[3]), 1 / (1 + uncertainty), 1 + uncertainty);
    next.lens.k = std::clamp(lens.k + step[4], -uncertainty / 2, uncertainty / 2);
    return next;
  }
};

// g π(R u(a)) - u(b), in sigma; a large constant if the rotated point is behind the camera.
Eigen::Vector2d ErrorOf(const Turn& turn, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector2d& sigma) {
  const auto [g, k] = turn.lens;
  const Eigen::Vector2d u_a = a.head<2>() * (1 + k * a.head<2>().squaredNorm()) / g;
  const Eigen::Vector2d u_b = b.head<2>() * (1 + k * b.head<2>().squaredNorm());
  const Eigen::Vector3d p = turn.R * u_a.homogeneous();
  if (p.z() < 0.05) return Eigen::Vector2d::Constant(1e6);
  return (g * p.head<2>() / p.z() - u_b).cwiseQuotient(sigma);
}

// Sum of squared errors, each truncated at `bound`, plus priors with standard deviation
// `uncertainty` on log(g) and `uncertainty` / 2 on k.
double CostOf(const Turn& turn, const RayPairs& rays, double uncertainty, double bound) {
  const double g = std::log(turn.lens.g) / uncertainty, k = 2 * turn.lens.k / uncertainty;
  double cost = g * g + k * k;
  for (size_t i = 0; i < rays.size(); ++i)
    cost += std::min(bound, ErrorOf(turn, rays.a[i], rays.b[i], rays.sigma).squaredNorm());
  return cost;
}

// One Levenberg-Marquardt step; increases the damping until the cost falls. False if it never does.
bool Improve(Turn& turn, const RayPairs& rays, double uncertainty, double bound) {
  constexpr double kDifference = 1e-6;  // step of the numerical derivatives
  Matrix5d H = Matrix5d::Zero();
  Vector5d g = Vector5d::Zero();
  for (size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector2d error = ErrorOf(turn, rays.a[i], rays.b[i], rays.sigma);
    if (!(error.squaredNorm() < bound)) continue;
    Eigen::Matrix<double, 2, 5> J;
    for (int p = 0; p < 5; ++p) {
      const Turn moved = turn.Stepped(kDifference * Vector5d::Unit(p), 10);
      J.col(p) = (ErrorOf(moved, rays.a[i], rays.b[i], rays.sigma) - error) / kDifference;
    }
    H += J.transpose() * J;
    g += J.transpose() * error;
  }
  const double weight = 1 / (uncertainty * uncertainty);
  H(3, 3) += weight;
  H(4, 4) += 4 * weight;
  g[3] += weight * std::log(turn.lens.g);
  g[4] += 4 * weight * turn.lens.k;
  const double cost = CostOf(turn, rays, uncertainty, bound);
  for (double damping = 1e-6; damping < 1e4; damping *= 100) {
    Matrix5d damped = H;
    damped.diagonal() *= 1 + damping;
    const Vector5d step = -damped.ldlt().solve(g);
    if (!step.allFinite()) return false;
    const Turn next = turn.Stepped(step, uncertainty);
    if (CostOf(next, rays, uncertainty, bound) < cost) {
      turn = next;
      return true;
    }
  }
  return false;
}

// Rotation from the rays of a to those of b if the focal length is g times the assumed one: R =
// argmin Σ |R a / |a| - b / |b||², from the SVD of Σ b a' (Kabsch 1976).
Turn TurnWith(double g, const RayPairs& rays) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d a(rays.a[i].x() / g, rays.a[i].y() / g, 1);
    const Eigen::Vector3d b(rays.b[i].x() / g, rays.b[i].y() / g, 1);
    sum += b.normalized() * a.normalized().transpose();
  }
  return {NearestRotation(sum), {g, 0}};
}

// Starting points: `R` with the assumed lens, and closed-form rotations for a few other focal
// lengths. A single start can converge to a too large radial coefficient (large rotations with a
// wrong focal length).
std::vector<Turn> Starts(const Eigen::Matrix3d& R, const RayPairs& rays, double uncertainty) {
  constexpr int kLenses = 7;
  std::vector<Turn> starts{{R, {}}};
  for (int i = 0; i < kLenses; ++i) {
    const double exponent = 2.0 * i / (kLenses - 1) - 1;  // -1 … 1
    starts.push_back(TurnWith(std::pow(1 + uncertainty, exponent), rays));
  }
  return starts;
}

}  // namespace

std::vector<bool> ExplainedByTurnedLens(const Eigen::Matrix3d& R, const RayPairs& rays,
                                        double uncertainty, LensChange* found) {
  constexpr int kIterations = 5;  // per gate
  constexpr double kGate = 2 * kChi2Homography;
  constexpr double kEnough = 0.9;  // share of matches explained at which no other start is tried
  std::vector<bool> most;
  ptrdiff_t count = -1;
  std::vector<Turn> starts = Starts(R, rays, uncertainty);
  while (!starts.empty()) {
    // Take the start with the lowest cost.
    size_t next = 0;
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < starts.size(); ++i) {
      const double cost = CostOf(starts[i], rays, uncertainty, 64 * kGate);
      if (cost >= least) continue;
      least = cost;
      next = i;
    }
    Turn turn = starts[next];
    starts.erase(starts.begin() + static_cast<ptrdiff_t>(next));
    for (const double widening : {1e4, 64.0, 16.0, 4.0, 1.0}) {
      const double bound = widening * kGate;
      for (int i = 0; i < kIterations && Improve(turn, rays, uncertainty, bound); ++i) continue;
    }
    std::vector<bool> explained;
    for (size_t i = 0; i < rays.size(); ++i)
      explained.push_back(ErrorOf(turn, rays.a[i], rays.b[i], rays.sigma).squaredNorm() < kGate);
    const ptrdiff_t these = std::count(explained.begin(), explained.end(), true);
    if (these <= count) continue;
    count = these;
    most = std::move(explained);
    if (found) *found = turn.lens;
    if (static_cast<double>(count) >= kEnough * static_cast<double>(rays.size())) break;
  }
  return most;
}

}  // namespace alidade
