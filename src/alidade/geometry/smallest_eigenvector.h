// Unit vector x that minimizes x' M x. It solves the homogeneous linear systems A x = 0 of this
// folder, with M = A' A (Hartley & Zisserman, A5.3).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace alidade {

// `m` is symmetric positive semi-definite; only its lower triangle is read. Inverse iteration on a
// Cholesky factorization: for a 9x9 matrix about eight times as fast as a full eigenvalue
// decomposition, and RANSAC calls it hundreds of times. If the two smallest eigenvalues are nearly
// equal, the result lies in the span of their eigenvectors. Non-finite input gives non-finite
// output.
template <int N>
Eigen::Matrix<double, N, 1> SmallestEigenvector(const Eigen::Matrix<double, N, N>& m) {
  // M = L D L'. Pivots are kept away from zero: for an exact solution the last one is rounding
  // noise of either sign.
  const double smallest_pivot = 1e-15 * m.trace();
  Eigen::Matrix<double, N, N> l = m;  // lower triangle used, unit diagonal implied
  std::array<double, N> inverse_pivot;
  for (int j = 0; j < N; ++j) {
    inverse_pivot[j] = 1 / std::max(l(j, j), smallest_pivot);
    for (int k = j + 1; k < N; ++k) {
      const double factor = l(k, j) * inverse_pivot[j];
      for (int i = k; i < N; ++i) l(i, k) -= l(i, j) * factor;
    }
    for (int i = j + 1; i < N; ++i) l(i, j) *= inverse_pivot[j];
  }
  Eigen::Matrix<double, N, 1> x;
  for (int i = 0; i < N; ++i)
    // A start that is unlikely to be orthogonal to the solution.
    x[i] = 1 - 0.37 * (i % 3) - 0.11 * i;
  x.normalize();
  for (int iteration = 0; iteration < 20; ++iteration) {
    Eigen::Matrix<double, N, 1> y = x;
    for (int j = 0; j < N; ++j) {
      for (int i = j + 1; i < N; ++i) y[i] -= l(i, j) * y[j];
    }
    for (int j = N - 1; j >= 0; --j) {
      double sum = y[j] * inverse_pivot[j];
      for (int i = j + 1; i < N; ++i) sum -= l(i, j) * y[i];
      y[j] = sum;
    }
    y /= y.cwiseAbs().maxCoeff();  // the first solves may come close to the largest double
    y.normalize();
    const double change = 1 - std::abs(x.dot(y));
    x = y;
    if (change < 1e-15) break;
  }
  return x;
}

}  // namespace alidade
