// The formulas of sighting_terms.h for several sightings at once. Includes no functions but
// templates, so that files for other processors can include it (cpu.h); they declare Sqrt(V) for
// their vectors V before.
#pragma once

#include "alidade/optimize/reprojection_formula.h"
#include "alidade/optimize/sighting_terms.h"

namespace alidade {

template <typename V>
struct SightingLanes {
  V R[9], centre[3], X[3];  // R_camera_world by columns; world frame
  V seen[8];                // u, v, right, weight, weight_r, huber, inv_c2, trust of BundleSighting
};

// Indices of SightingTerms::camera, then Y and cost.
inline constexpr int kTermsN = 0, kTermsC = 6, kTermsRr = 15, kTermsG = 21, kTermsY = 28,
                     kTermsCost = 31, kTermsSize = 32;

// C = [Y]x N, C [Y]x', and Y × g.
template <typename V>
[[gnu::always_inline]] inline void TurnTerms(const V* Y, V* terms) {
  const V x = Y[0], y = Y[1], z = Y[2];
  const V* N = terms + kTermsN;
  V* C = terms + kTermsC;
  C[0] = y * N[2] - z * N[1];
  C[1] = y * N[4] - z * N[3];
  C[2] = y * N[5] - z * N[4];
  C[3] = z * N[0] - x * N[2];
  C[4] = z * N[1] - x * N[4];
  C[5] = z * N[2] - x * N[5];
  C[6] = x * N[1] - y * N[0];
  C[7] = x * N[3] - y * N[1];
  C[8] = x * N[4] - y * N[2];
  V* rr = terms + kTermsRr;
  rr[0] = y * C[2] - z * C[1];
  rr[1] = z * C[0] - x * C[2];
  rr[2] = x * C[1] - y * C[0];
  rr[3] = z * C[3] - x * C[5];
  rr[4] = x * C[4] - y * C[3];
  rr[5] = x * C[7] - y * C[6];
  V* g = terms + kTermsG;
  g[3] = y * g[2] - z * g[1];
  g[4] = z * g[0] - x * g[2];
  g[5] = x * g[1] - y * g[0];
  g[6] = V{};
}

// Sets all kTermsSize numbers, without `derivatives` only the cost.
template <typename V>
[[gnu::always_inline]] inline void FillTerms(const SightingLens& k, const SightingLanes<V>& s,
                                             bool derivatives, V* terms) {
  const V* R = s.R;
  const V huber = s.seen[5], inv_c2 = s.seen[6], trust = s.seen[7];
  V Y[3];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) Y[i] = s.X[i] - s.centre[i];
  const V x = R[0] * Y[0] + R[3] * Y[1] + R[6] * Y[2];
  const V y = R[1] * Y[0] + R[4] * Y[1] + R[7] * Y[2];
  const V z = R[2] * Y[0] + R[5] * Y[1] + R[8] * Y[2];
  const Reprojection<V> e = Reproject<V>(k, x, y, z, s.seen[0], s.seen[1], s.seen[2]);
  V w = s.seen[3], wr = s.seen[4];
  const V one = V{} + 1, infinite = V{} + __builtin_inf();
  const V chi2 = w * (e.u * e.u + e.v * e.v) + wr * (e.d * e.d);
  const V root = Sqrt(chi2), inner = root < huber ? root : huber;
  // Huber's loss times Geman & McClure's factor; one of the two is always inactive.
  const V q = one / (one + chi2 * inv_c2);
  const V cost = trust * (inner * (root - 0.5 * inner)) * q;
  terms[kTermsCost] = z > kMinDepth ? cost : infinite;
  if (!derivatives) return;
  const V say = trust * (root > huber ? huber / root : one) * (q * q);
  w *= say;
  wr *= say;
  // Rows of B = A R, with A the derivative by the point in the camera frame.
  V U[3], W[3], S[3];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    U[i] = e.u_x * R[3 * i] + e.u_z * R[3 * i + 2];
    W[i] = e.v_y * R[3 * i + 1] + e.v_z * R[3 * i + 2];
    S[i] = e.d_z * R[3 * i + 2];
  }
#pragma GCC unroll 3
  for (int i = 0, at = kTermsN; i < 3; ++i) {
    const V a = w * U[i], b = w * W[i], r = wr * S[i];
    terms[kTermsG + i] = a * e.u + b * e.v + r * e.d;
#pragma GCC unroll 3
    for (int j = i; j < 3; ++j) terms[at++] = a * U[j] + b * W[j] + r * S[j];
    terms[kTermsY + i] = Y[i];
  }
  TurnTerms(Y, terms);
}

}  // namespace alidade
