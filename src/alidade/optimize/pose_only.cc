#include "alidade/optimize/pose_only.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/optimize/double2.h"
#include "alidade/optimize/reprojection.h"

namespace alidade {
namespace {

// Two matches, processed in parallel.
struct MatchPair {
  Double2 x, y, z;           // landmark, world frame
  Double2 u, v, right;       // observed position, pixels
  Double2 weight, weight_r;  // 1/px²; 0: the match, or its u_right, is not usable
  Double2 huber;             // standard deviations
  Double2 trust;             // 0 to 1
  Mask2 active;              // all ones: used in this round
};

// Limit of the truncation correction: with heavier noise the truncated residuals do not determine
// the noise level.
constexpr double kMostCut = 2;

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double cost = 0;
};

std::vector<MatchPair> Pack(const Intrinsics& k, std::span<const PoseMatch> matches,
                            const PoseOnlySettings& settings) {
  MatchPair none;
  none.x = none.y = none.u = none.v = none.right = none.weight = none.weight_r = Both(0);
  none.z = none.huber = none.trust = Both(1);
  none.active = Mask2{0, 0};
  std::vector<MatchPair> pairs((matches.size() + 1) / 2, none);
  for (size_t i = 0; i < matches.size(); ++i) {
    const PoseMatch& m = matches[i];
    if (!m.p_world.allFinite() || !m.pixel.head<2>().allFinite()) continue;
    if (!(m.inv_sigma2 > 0) || !std::isfinite(m.inv_sigma2) || !(m.trust > 0)) continue;
    const bool stereo =
        HasRight(k, m.pixel.z()) && m.inv_sigma2_right > 0 && std::isfinite(m.inv_sigma2_right);
    MatchPair& p = pairs[i / 2];
    const int lane = i % 2;
    p.x[lane] = m.p_world.x();
    p.y[lane] = m.p_world.y();
    p.z[lane] = m.p_world.z();
    p.u[lane] = m.pixel.x();
    p.v[lane] = m.pixel.y();
    p.right[lane] = stereo ? m.pixel.z() : 0;
    p.weight[lane] = m.inv_sigma2;
    p.weight_r[lane] = stereo ? m.inv_sigma2_right : 0;
    p.trust[lane] = m.trust;
    p.huber[lane] = stereo ? settings.huber_stereo : settings.huber_mono;
    p.active[lane] = -1;
  }
  return pairs;
}

// A pair observed from a pose.
struct Seen {
  Double2 x, y, z;  // camera frame; z clamped to be positive
  Reprojection<Double2> e;
  Double2 chi2;
  Mask2 in_front;
};

[[gnu::always_inline]] inline Seen Look(const Intrinsics& k, const Se3& T, const MatchPair& m) {
  Seen s;
  s.x = T.R(0, 0) * m.x + T.R(0, 1) * m.y + T.R(0, 2) * m.z + T.t.x();
  s.y = T.R(1, 0) * m.x + T.R(1, 1) * m.y + T.R(1, 2) * m.z + T.t.y();
  const Double2 depth = T.R(2, 0) * m.x + T.R(2, 1) * m.y + T.R(2, 2) * m.z + T.t.z();
  s.z = Max(depth, Both(kMinDepth));
  s.in_front = depth > kMinDepth;
  s.e = Reproject<Double2>(k, s.x, s.y, s.z, m.u, m.v, m.right);
  s.chi2 = m.weight * (s.e.u * s.e.u + s.e.v * s.e.v) + m.weight_r * (s.e.d * s.e.d);
  return s;
}

// Cap on chi² per weight: the loss is constant beyond it and behind the camera. A wrong match that
// moves behind the camera therefore neither blocks nor favors a step.
double FarChi2PerWeight(const Intrinsics& k) { return 16 * k.fx * k.fx; }

// The Jacobian of the left increment (translation; rotation) is A [I, -[p]x], with A the derivative
// by the point in the camera frame. With M = A' W A the blocks of J' W J are M, -M [p]x and [p]x M
// [p]x' (Solà et al. 2018, eq. 182).
NormalEquations Linearise(const Intrinsics& k, const Se3& T, const std::vector<MatchPair>& pairs,
                          bool robust) {
  const Double2 zero = Both(0);
  Double2 m00 = zero, m02 = zero, m11 = zero, m12 = zero, m22 = zero, cost = zero;
  Double2 c00 = zero, c01 = zero, c02 = zero, c10 = zero, c11 = zero, c12 = zero, c20 = zero,
          c21 = zero, c22 = zero;
  Double2 r00 = zero, r01 = zero, r02 = zero, r11 = zero, r12 = zero, r22 = zero;
  Double2 g0 = zero, g1 = zero, g2 = zero, g3 = zero, g4 = zero, g5 = zero;
  const double far = FarChi2PerWeight(k);
  for (const MatchPair& m : pairs) {
    const Seen s = Look(k, T, m);
    const Double2 cap = far * m.weight;
    const Double2 chi2 = Min(s.chi2, cap);
    const Mask2 near = (s.chi2 < cap) & s.in_front & m.active;
    Double2 w = near ? m.weight * m.trust : zero, wr = near ? m.weight_r * m.trust : zero, loss;
    if (robust) {
      const Double2 root = Sqrt(chi2);
      const Double2 irls = Min(m.huber / Max(root, Both(1e-9)), Both(1));
      // Half of the Huber loss, both branches in one: root² / 2 below the bound, huber (root -
      // huber / 2) above.
      const Double2 inner = Min(root, m.huber);
      loss = inner * (root - 0.5 * inner);
      w *= irls;
      wr *= irls;
    } else {
      loss = 0.5 * chi2;
    }
    cost += m.active ? loss * m.trust : zero;
    const Double2 wu = w * s.e.u_x, wv = w * s.e.v_y;
    const Double2 a = wu * s.e.u_x, b = wv * s.e.v_y;
    const Double2 c = wu * s.e.u_z, d = wv * s.e.v_z;
    const Double2 f = w * (s.e.u_z * s.e.u_z + s.e.v_z * s.e.v_z) + wr * (s.e.d_z * s.e.d_z);
    const Double2 h0 = wu * s.e.u, h1 = wv * s.e.v;
    const Double2 h2 = w * (s.e.u_z * s.e.u + s.e.v_z * s.e.v) + wr * (s.e.d_z * s.e.d);
    m00 += a;
    m02 += c;
    m11 += b;
    m12 += d;
    m22 += f;
    // C = -M [p]x; M = (a 0 c; 0 b d; c d f).
    const Double2 k00 = c * s.y, k01 = a * s.z - c * s.x, k02 = -(a * s.y);
    const Double2 k10 = d * s.y - b * s.z, k11 = -(d * s.x), k12 = b * s.x;
    const Double2 k20 = f * s.y - d * s.z, k21 = c * s.z - f * s.x, k22 = d * s.x - c * s.y;
    c00 += k00;
    c01 += k01;
    c02 += k02;
    c10 += k10;
    c11 += k11;
    c12 += k12;
    c20 += k20;
    c21 += k21;
    c22 += k22;
    // [p]x C, upper triangle.
    r00 += s.y * k20 - s.z * k10;
    r01 += s.y * k21 - s.z * k11;
    r02 += s.y * k22 - s.z * k12;
    r11 += s.z * k01 - s.x * k21;
    r12 += s.z * k02 - s.x * k22;
    r22 += s.x * k12 - s.y * k02;
    g0 += h0;
    g1 += h1;
    g2 += h2;
    g3 += s.y * h2 - s.z * h1;
    g4 += s.z * h0 - s.x * h2;
    g5 += s.x * h1 - s.y * h0;
  }
  NormalEquations n;
  n.H.row(0) << Sum(m00), 0, Sum(m02), Sum(c00), Sum(c01), Sum(c02);
  n.H.row(1) << 0, Sum(m11), Sum(m12), Sum(c10), Sum(c11), Sum(c12);
  n.H.row(2) << 0, 0, Sum(m22), Sum(c20), Sum(c21), Sum(c22);
  n.H.row(3) << 0, 0, 0, Sum(r00), Sum(r01), Sum(r02);
  n.H.row(4) << 0, 0, 0, 0, Sum(r11), Sum(r12);
  n.H.row(5) << 0, 0, 0, 0, 0, Sum(r22);
  n.H.triangularView<Eigen::StrictlyLower>() = n.H.transpose();
  n.g << Sum(g0), Sum(g1), Sum(g2), Sum(g3), Sum(g4), Sum(g5);
  n.cost = Sum(cost);
  return n;
}

struct Descent {
  Se3 T;
  NormalEquations at_end;
};

// Levenberg–Marquardt with minimal damping: Gauss–Newton while the cost falls. Ends when the
// predicted gain is less than `tolerance` of the cost.
Descent Descend(const Intrinsics& k, const Se3& start, const std::vector<MatchPair>& pairs,
                bool robust, int max_iterations, double tolerance) {
  Descent d{start, Linearise(k, start, pairs, robust)};
  double lambda = 1e-9;
  for (int i = 0; i < max_iterations; ++i) {
    Matrix6d damped = d.at_end.H;
    const double largest = damped.diagonal().maxCoeff();
    damped.diagonal() += lambda * d.at_end.H.diagonal();
    damped.diagonal().array() += 1e-12 * largest + 1e-300;
    const Vector6d step = -damped.llt().solve(d.at_end.g);
    const double gain = -0.5 * d.at_end.g.dot(step);
    if (!step.allFinite() || !(gain >= 0)) break;
    const Se3 trial = Se3::Exp(step) * d.T;
    // Accept such a small step without evaluating it.
    if (gain < tolerance * d.at_end.cost + 1e-12) {
      d.T = trial;
      d.at_end.cost -= gain;
      break;
    }
    const NormalEquations next = Linearise(k, trial, pairs, robust);
    if (next.cost < d.at_end.cost) {
      d.T = trial;
      d.at_end = next;
      lambda = std::max(lambda * 0.1, 1e-9);
    } else {
      lambda = std::max(lambda * 10, 1e-3);
    }
  }
  return d;
}

// Updates the inlier flags by the gate. Returns true if any changed.
bool Reclassify(const Intrinsics& k, const Se3& T, std::vector<MatchPair>& pairs, int& inliers) {
  bool changed = false;
  inliers = 0;
  for (MatchPair& m : pairs) {
    const Seen s = Look(k, T, m);
    for (int lane = 0; lane < 2; ++lane) {
      const bool inlier = m.weight[lane] > 0 && s.in_front[lane] != 0 &&
                          s.chi2[lane] <= m.huber[lane] * m.huber[lane];
      changed |= inlier != (m.active[lane] != 0);
      m.active[lane] = inlier ? -1 : 0;
      inliers += inlier;
    }
  }
  return changed;
}

double Measured(const std::vector<MatchPair>& pairs) {
  double sum = 0;
  for (const MatchPair& m : pairs) {
    for (int lane = 0; lane < 2; ++lane) {
      if (m.active[lane] != 0) sum += m.trust[lane] * (m.weight_r[lane] > 0 ? 3 : 2);
    }
  }
  return sum;
}

}  // namespace

Matrix6d PoseCovariance(const Matrix6d& information, double cost, double measured, double gate) {
  const double free = measured - 6;
  if (!(free > 0)) return Matrix6d::Zero();
  // Scale to unit diagonal: meters and radians may differ by orders of magnitude.
  const Vector6d scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LDLT<Matrix6d> solver(scaled);
  constexpr double kSingular = 1e-10;  // of the largest pivot; below it only rounding remains
  const Vector6d pivots = solver.vectorD();
  if (!(pivots.minCoeff() > kSingular * pivots.maxCoeff())) return Matrix6d::Zero();
  const double raw = 2 * cost / free;
  double factor = raw;
  // Fixed-point iteration: the truncation correction depends on the noise.
  for (int i = 0; i < 20; ++i) {
    const double half = 0.5 * gate / factor;
    const double kept = half < 500 ? 1 - half / std::expm1(half) : 1;
    factor = std::min(raw / std::max(kept, 1e-3), kMostCut * raw);
  }
  const Matrix6d inverse = solver.solve(Matrix6d::Identity());
  const Matrix6d covariance = factor * (scale.asDiagonal() * inverse * scale.asDiagonal());
  return 0.5 * (covariance + covariance.transpose());
}

void PoseOnlySettings::Check() const {
  if (max_iterations < 1) ThrowUsage("max_iterations: must be at least 1");
  if (rounds < 1) ThrowUsage("rounds: must be at least 1");
  if (!(huber_mono > 0) || !std::isfinite(huber_mono)) ThrowUsage("huber_mono: must be above 0");
  if (!(huber_stereo > 0) || !std::isfinite(huber_stereo)) {
    ThrowUsage("huber_stereo: must be above 0");
  }
}

PoseOnlyResult OptimizePose(const Camera& camera, const Se3& T_camera_world,
                            std::span<const PoseMatch> matches, const PoseOnlySettings& settings) {
  PoseOnlyResult result;
  result.T_camera_world = T_camera_world;
  result.inlier.assign(matches.size(), false);
  if (matches.size() < 3) return result;

  const Intrinsics k = Intrinsics::Of(camera);
  std::vector<MatchPair> pairs = Pack(k, matches, settings);
  int usable = 0;
  for (const MatchPair& m : pairs) usable -= static_cast<int>(m.active[0] + m.active[1]);
  if (usable < 3) return result;

  // Before the inliers are final, a pose within a fraction of its standard deviation suffices.
  Se3 T = T_camera_world;
  for (int round = 0; round < settings.rounds; ++round) {
    const bool robust = round == 0 || round + 1 < settings.rounds;
    T = Descend(k, T, pairs, robust, settings.max_iterations, 1e-3).T;
    if (!Reclassify(k, T, pairs, result.inliers)) break;
    if (result.inliers < 3 && round + 1 < settings.rounds) {
      for (MatchPair& m : pairs) m.active = m.weight > 0;
    }
  }
  const Descent last = Descend(k, T, pairs, false, settings.max_iterations, 1e-7);
  result.T_camera_world = last.T.Normalised();
  result.information = last.at_end.H;
  result.cost = last.at_end.cost;
  result.measured = Measured(pairs);
  result.covariance = PoseCovariance(result.information, result.cost, result.measured,
                                     settings.huber_mono * settings.huber_mono);
  for (size_t i = 0; i < matches.size(); ++i) result.inlier[i] = pairs[i / 2].active[i % 2] != 0;
  return result;
}

}  // namespace alidade
