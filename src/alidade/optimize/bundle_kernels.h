// Small dense products in the inner loop of bundle adjustment: one point and one camera at a time,
// fixed sizes, all inline.
//
// A point has the block H (3x3, symmetric) and the gradient g; with each free camera that observes
// it, it has the coupling block G N, where G = [I; [Y]x] is 6x3 (see bundle_linearise.h).
// Eliminating the point updates the reduced system S δ = r of its cameras a, b:
//   S -= (G_a N_a) H^-1 (G_b N_b)'   and   r += (G_a N_a) H^-1 g.
// With H = L L' and E_a = G_a N_a L'^-1 this is S -= E_a E_b' and r += E_a L^-1 g: one triangular
// solve per camera and one product per pair (Triggs et al. 2000, §6.1).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "alidade/optimize/block_cholesky.h"
#include "alidade/optimize/bundle_linearise.h"

namespace alidade {

// Marquardt damping added to a diagonal entry d; `largest` is the largest entry of the same kind.
// The last term keeps unobserved directions invertible.
inline double DampingOfEntry(double lambda, double d, double largest) {
  return std::max(lambda * std::max(d, 1e-6 * largest), 1e-12 * largest);
}

// Damping of a point's H; x, y, z are of one kind.
inline std::array<double, 3> DampingOf(const Symmetric3& H, double lambda) {
  const double largest = std::max({H[0], H[3], H[5]});
  return {DampingOfEntry(lambda, H[0], largest), DampingOfEntry(lambda, H[3], largest),
          DampingOfEntry(lambda, H[5], largest)};
}

// Damping of a camera's block; translations are of one kind, rotations of another.
inline Vector6d DampingOf(const CameraBlock& block, double lambda) {
  const Vector6d d = block.Hessian().diagonal();
  const double t = d.head<3>().maxCoeff(), r = d.tail<3>().maxCoeff();
  Vector6d damping;
  for (int i = 0; i < 6; ++i) damping[i] = DampingOfEntry(lambda, d[i], i < 3 ? t : r);
  return damping;
}

// Damping of a state of the inertial sensor; velocities are of one kind, biases of another.
inline Vector6d DampingOf(const StateBlock& block, double lambda) {
  const Vector6d d = block.H.diagonal();
  const double v = d.head<3>().maxCoeff(), b = d.tail<3>().maxCoeff();
  Vector6d damping;
  for (int i = 0; i < 6; ++i) damping[i] = DampingOfEntry(lambda, d[i], i < 3 ? v : b);
  return damping;
}

// Factor of one point: H + diag(damping) = L L'. Stores 1 / l00, 1 / l11, 1 / l22 instead of the
// pivots. Not finite if the sum is not positive definite.
struct PointFactor {
  double l00, l10, l11, l20, l21, l22;
};

inline PointFactor FactorOf(const Symmetric3& H, const std::array<double, 3>& damping) {
  PointFactor L;
  L.l00 = 1 / std::sqrt(H[0] + damping[0]);
  L.l10 = H[1] * L.l00;
  L.l20 = H[2] * L.l00;
  L.l11 = 1 / std::sqrt(H[3] + damping[1] - L.l10 * L.l10);
  L.l21 = (H[4] - L.l20 * L.l10) * L.l11;
  L.l22 = 1 / std::sqrt(H[5] + damping[2] - L.l20 * L.l20 - L.l21 * L.l21);
  return L;
}

// L^-1 b.
inline std::array<double, 3> SolveLower(const PointFactor& L, const std::array<double, 3>& b) {
  const double y0 = b[0] * L.l00;
  const double y1 = (b[1] - L.l10 * y0) * L.l11;
  const double y2 = (b[2] - L.l20 * y0 - L.l21 * y1) * L.l22;
  return {y0, y1, y2};
}

// L'^-1 y.
inline Eigen::Vector3d SolveUpper(const PointFactor& L, const std::array<double, 3>& y) {
  Eigen::Vector3d x;
  x[2] = y[2] * L.l22;
  x[1] = (y[1] - L.l21 * x[2]) * L.l11;
  x[0] = (y[0] - L.l10 * x[1] - L.l20 * x[2]) * L.l00;
  return x;
}

// E = G N L'^-1 of one coupling: 6x3, column-major, aligned for vector loads.
struct alignas(16) CouplingFactor {
  double column[3][6];

  Double2 Rows(int pair, int j) const {
    return Double2{column[j][2 * pair], column[j][2 * pair + 1]};
  }
};

// N is symmetric, so the rows of E's upper half are L^-1 times the columns of N; the lower half is
// Y × each of its columns.
inline void MakeFactor(const Coupling& c, const PointFactor& L, CouplingFactor& factor) {
  const Symmetric3& N = c.N;
  const double n[3][3] = {{N[0], N[1], N[2]}, {N[1], N[3], N[4]}, {N[2], N[4], N[5]}};
  const double x = c.Y[0], y = c.Y[1], z = c.Y[2];
  double E[3][3];
  for (int i = 0; i < 3; ++i) {
    E[0][i] = n[i][0] * L.l00;
    E[1][i] = (n[i][1] - L.l10 * E[0][i]) * L.l11;
    E[2][i] = (n[i][2] - L.l20 * E[0][i] - L.l21 * E[1][i]) * L.l22;
  }
  for (int j = 0; j < 3; ++j) {
    double* column = factor.column[j];
    for (int i = 0; i < 3; ++i) column[i] = E[j][i];
    column[3] = y * E[j][2] - z * E[j][1];
    column[4] = z * E[j][0] - x * E[j][2];
    column[5] = x * E[j][1] - y * E[j][0];
  }
}

// r += E y
inline void AddProduct(const CouplingFactor& E, const std::array<double, 3>& y, Vector6d& r) {
  for (int i = 0; i < 6; ++i) {
    r[i] += E.column[0][i] * y[0] + E.column[1][i] * y[1] + E.column[2][i] * y[2];
  }
}

// S -= A B'
[[gnu::always_inline]] inline void SubtractProduct(const CouplingFactor& A, const CouplingFactor& B,
                                                   SquareBlock<6>& S) {
  for (int j = 0; j < 6; j += 2) {  // two columns at a time: as many as fit in registers
    Double2 sum[2][3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      sum[0][i] = S.column[j][i];
      sum[1][i] = S.column[j + 1][i];
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      const Double2 b0 = Both(B.column[k][j]), b1 = Both(B.column[k][j + 1]);
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        const Double2 a = A.Rows(i, k);
        sum[0][i] -= a * b0;
        sum[1][i] -= a * b1;
      }
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      S.column[j][i] = sum[0][i];
      S.column[j + 1][i] = sum[1][i];
    }
  }
}

// r -= N G' δ = N (ρ + θ × Y) for the camera's step δ = (ρ, θ).
inline void SubtractStep(const Coupling& c, const Vector6d& d, std::array<double, 3>& r) {
  const double m0 = d[0] + d[4] * c.Y[2] - d[5] * c.Y[1];
  const double m1 = d[1] + d[5] * c.Y[0] - d[3] * c.Y[2];
  const double m2 = d[2] + d[3] * c.Y[1] - d[4] * c.Y[0];
  r[0] -= c.N[0] * m0 + c.N[1] * m1 + c.N[2] * m2;
  r[1] -= c.N[1] * m0 + c.N[3] * m1 + c.N[4] * m2;
  r[2] -= c.N[2] * m0 + c.N[4] * m1 + c.N[5] * m2;
}

}  // namespace alidade
