#include "alidade/optimize/bundle_schur.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "alidade/base/parallel.h"

namespace alidade {
namespace {

// What is added to a diagonal entry d (Marquardt), `largest` being the largest of its kind.
// Directions that nothing was seen of have no scale of their own; the last term keeps them
// invertible.
inline double Damping(double lambda, double d, double largest) {
  return std::max(lambda * std::max(d, 1e-6 * largest), 1e-12 * largest);
}

// Time of the sparse factor's multiplications against the dense one's, measured.
constexpr double kSparseCost = 1.5;

struct PointDamping {
  double x, y, z;
};
inline PointDamping DampingOf(const Symmetric3& H, double lambda) {
  const double largest = std::max({H[0], H[3], H[5]});
  return {Damping(lambda, H[0], largest), Damping(lambda, H[3], largest),
          Damping(lambda, H[5], largest)};
}

Vector6d DampingOf(const CameraBlock& block, double lambda) {
  const Vector6d d = block.Hessian().diagonal();
  const double t = d.head<3>().maxCoeff(), r = d.tail<3>().maxCoeff();
  Vector6d damping;
  for (int i = 0; i < 6; ++i) damping[i] = Damping(lambda, d[i], i < 3 ? t : r);
  return damping;
}

// G N L'^-1 of one coupling: 6x3, column by column, and as the compiler's vectors.
struct alignas(16) Factor {
  double column[3][6];

  Double2 Rows(int pair, int j) const {
    return Double2{column[j][2 * pair], column[j][2 * pair + 1]};
  }
};

inline void MakeFactor(const Coupling& c, const double l[6], Factor& factor) {
  const Symmetric3& N = c.N;
  const double n[3][3] = {{N[0], N[1], N[2]}, {N[1], N[3], N[4]}, {N[2], N[4], N[5]}};
  const double x = c.Y[0], y = c.Y[1], z = c.Y[2];
  double E[3][3];
  for (int i = 0; i < 3; ++i) {
    E[0][i] = n[i][0] * l[0];
    E[1][i] = (n[i][1] - l[2] * E[0][i]) * l[1];
    E[2][i] = (n[i][2] - l[3] * E[0][i] - l[4] * E[1][i]) * l[5];
  }
  for (int j = 0; j < 3; ++j) {
    double* column = factor.column[j];
    for (int i = 0; i < 3; ++i) column[i] = E[j][i];
    column[3] = y * E[j][2] - z * E[j][1];
    column[4] = z * E[j][0] - x * E[j][2];
    column[5] = x * E[j][1] - y * E[j][0];
  }
}

// S -= A B'
[[gnu::always_inline]] inline void Subtract(const Factor& A, const Factor& B, SquareBlock<6>& S) {
  for (int j = 0; j < 6; j += 2) {  // two columns at a time: as many as stay in registers
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

}  // namespace

SchurSolver::SchurSolver(const BundleLayout& layout, ReducedFactor kind)
    : layout_(layout),
      sparse_(kind != ReducedFactor::kDense),
      cameras_(static_cast<int>(layout.free_cameras.size())),
      reduced_(layout.chunk_count()),
      eliminated_(layout.points.size()) {
  FindBlocks();
  if (!sparse_) return;
  // Where everybody saw the same, what the sparse factor saves it loses by working in small
  // pieces.
  const double size = 6.0 * cameras_, all_blocks = 0.5 * cameras_ * (cameras_ + 1.0);
  const bool may_pay = column_.size() < 0.5 * all_blocks;
  if (kind == ReducedFactor::kSparse || may_pay) Analyse();
  if (kind == ReducedFactor::kFastest &&
      !(may_pay && kSparseCost * factor_.Work() < size * size * size / 6)) {
    sparse_ = false;
    FindBlocks();
  }
}

void SchurSolver::FindBlocks() {
  row_begin_.assign(cameras_ + 1, 0);
  if (!sparse_) {
    for (int row = 0; row < cameras_; ++row) row_begin_[row + 1] = row_begin_[row] + row + 1;
    return;
  }
  std::vector<uint8_t> together(static_cast<size_t>(cameras_) * cameras_, 0);
  for (const BundlePoint& point : layout_.points) {
    for (int a = point.begin; a < point.free_end; ++a) {
      uint8_t* row = together.data() + static_cast<size_t>(layout_.sightings[a].slot) * cameras_;
      for (int b = point.begin; b <= a; ++b) row[layout_.sightings[b].slot] = 1;
    }
  }
  column_.clear();
  for (int i = 0; i < cameras_; ++i) {
    const uint8_t* row = together.data() + static_cast<size_t>(i) * cameras_;
    for (int j = 0; j <= i; ++j) {
      if (row[j]) column_.push_back(j);
    }
    row_begin_[i + 1] = static_cast<int>(column_.size());
  }
}

// `hint`: a block of the same row at or before the one looked for.
inline int SchurSolver::FindBlock(int row, int column, int hint) const {
  if (!sparse_) return row_begin_[row] + column;
  // Who sees the same point stands side by side, most of the time.
  const int end = row_begin_[row + 1], guess = hint + column - column_[hint];
  if (guess < end && column_[guess] == column) return guess;
  return static_cast<int>(std::lower_bound(column_.begin() + hint, column_.begin() + end, column) -
                          column_.begin());
}

void SchurSolver::Eliminate(const Linearisation& system, double lambda, int chunk,
                            Reduced& reduced) {
  reduced.blocks.assign(row_begin_[cameras_], SquareBlock<6>{});
  reduced.right.assign(cameras_, Vector6d::Zero());
  std::vector<Factor> factors;
  for (int j = layout_.chunks[chunk]; j < layout_.chunks[chunk + 1]; ++j) {
    const BundlePoint& point = layout_.points[j];
    const PointBlock& block = system.points[j];
    const PointDamping damping = DampingOf(block.H, lambda);
    Eliminated& L = eliminated_[j];
    L.l00 = 1 / std::sqrt(block.H[0] + damping.x);
    L.l10 = block.H[1] * L.l00;
    L.l20 = block.H[2] * L.l00;
    L.l11 = 1 / std::sqrt(block.H[3] + damping.y - L.l10 * L.l10);
    L.l21 = (block.H[4] - L.l20 * L.l10) * L.l11;
    L.l22 = 1 / std::sqrt(block.H[5] + damping.z - L.l20 * L.l20 - L.l21 * L.l21);

    const double l[6] = {L.l00, L.l11, L.l10, L.l20, L.l21, L.l22};
    const double y0 = block.g[0] * L.l00;
    const double y1 = (block.g[1] - L.l10 * y0) * L.l11;
    const double y2 = (block.g[2] - L.l20 * y0 - L.l21 * y1) * L.l22;
    const int count = point.free_end - point.begin;
    if (static_cast<int>(factors.size()) < count) factors.resize(count);
    const Coupling* couplings = system.couplings.data() + point.coupling;
    for (int a = 0; a < count; ++a) {
      Factor& E = factors[a];
      MakeFactor(couplings[a], l, E);
      const int row = couplings[a].slot;
      for (int i = 0; i < 6; ++i) {
        reduced.right[row][i] += E.column[0][i] * y0 + E.column[1][i] * y1 + E.column[2][i] * y2;
      }
      int at = row_begin_[row];
      for (int b = 0; b <= a; ++b) {
        at = FindBlock(row, couplings[b].slot, at);
        SquareBlock<6>& S = reduced.blocks[at];
        Subtract(E, factors[b], S);
        // A point seen twice by one camera.
        if (b < a && couplings[b].slot == row) Subtract(factors[b], E, S);
      }
    }
  }
}

void SchurSolver::AddCameras(const Linearisation& system, double lambda) {
  Reduced& sum = reduced_[0];
  for (size_t chunk = 1; chunk < reduced_.size(); ++chunk) {
    const Reduced& part = reduced_[chunk];
    for (size_t i = 0; i < sum.blocks.size(); ++i) sum.blocks[i].Add(part.blocks[i]);
    for (int i = 0; i < cameras_; ++i) sum.right[i] += part.right[i];
  }
  for (int i = 0; i < cameras_; ++i) {
    const CameraBlock& c = system.cameras[i];
    Matrix6d H = c.Hessian();
    H.diagonal() += DampingOf(c, lambda);
    SquareBlock<6>& S = sum.blocks[row_begin_[i + 1] - 1];  // the last of a row is on the diagonal
    for (int j = 0; j < 6; ++j) {
      for (int n = 0; n < 3; ++n) S.column[j][n] += Double2{H(2 * n, j), H(2 * n + 1, j)};
    }
    sum.right[i] -= c.Gradient();
  }
}

bool SchurSolver::SolveDense(Eigen::VectorXd& x) {
  const Reduced& reduced = reduced_[0];
  dense_.resize(6 * cameras_, 6 * cameras_);
  for (int row = 0, at = 0; row < cameras_; ++row) {
    for (int column = 0; column <= row; ++column, ++at) {
      for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < 6; ++i) dense_(6 * row + i, 6 * column + j) = reduced.blocks[at](i, j);
      }
    }
  }
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);
  if (factor.info() != Eigen::Success) return false;
  factor.solveInPlace(x);
  return true;
}

void SchurSolver::Analyse() {
  std::vector<BlockPlace> below;
  for (int row = 0; row < cameras_; ++row) {
    for (int at = row_begin_[row]; at + 1 < row_begin_[row + 1]; ++at) {
      below.push_back({row, column_[at]});
    }
  }
  factor_.Analyse(cameras_, below);
}

bool SchurSolver::SolveSparse(Eigen::VectorXd& x) {
  const Reduced& reduced = reduced_[0];
  factor_.Clear();
  size_t below = 0;
  for (int row = 0; row < cameras_; ++row) {
    const int diagonal = row_begin_[row + 1] - 1;
    for (int at = row_begin_[row]; at < diagonal; ++at) {
      factor_.SetBelow(below++, reduced.blocks[at]);
    }
    factor_.SetDiagonal(row, reduced.blocks[diagonal]);
  }
  if (!factor_.Factorise()) return false;
  factor_.Solve(x);
  return true;
}

// Points: (H + D) δ = -g - sum N (ρ + θ × Y), since N G' δ_camera is the last.
void SchurSolver::Substitute(const Linearisation& system, BundleStep& step) {
  step.points.resize(layout_.points.size());
  ParallelFor(layout_.chunk_count(), [&](int chunk) {
    for (int j = layout_.chunks[chunk]; j < layout_.chunks[chunk + 1]; ++j) {
      const BundlePoint& point = layout_.points[j];
      const PointBlock& block = system.points[j];
      double r0 = -block.g[0], r1 = -block.g[1], r2 = -block.g[2];
      const Coupling* c = system.couplings.data() + point.coupling;
      for (int n = point.free_end - point.begin; n > 0; --n, ++c) {
        const Vector6d& d = step.cameras[c->slot];
        const double m0 = d[0] + d[4] * c->Y[2] - d[5] * c->Y[1];
        const double m1 = d[1] + d[5] * c->Y[0] - d[3] * c->Y[2];
        const double m2 = d[2] + d[3] * c->Y[1] - d[4] * c->Y[0];
        r0 -= c->N[0] * m0 + c->N[1] * m1 + c->N[2] * m2;
        r1 -= c->N[1] * m0 + c->N[3] * m1 + c->N[4] * m2;
        r2 -= c->N[2] * m0 + c->N[4] * m1 + c->N[5] * m2;
      }
      const Eliminated& L = eliminated_[j];
      const double y0 = r0 * L.l00;
      const double y1 = (r1 - L.l10 * y0) * L.l11;
      const double y2 = (r2 - L.l20 * y0 - L.l21 * y1) * L.l22;
      Eigen::Vector3d& x = step.points[j];
      x[2] = y2 * L.l22;
      x[1] = (y1 - L.l21 * x[2]) * L.l11;
      x[0] = (y0 - L.l10 * x[1] - L.l20 * x[2]) * L.l00;
    }
  });
}

// ½ (δ' D δ - g' δ): what -g' δ - ½ δ' H δ is where (H + D) δ = -g.
double SchurSolver::Predicted(const Linearisation& system, double lambda,
                              const BundleStep& step) const {
  double twice = 0;
  for (int i = 0; i < cameras_; ++i) {
    const Vector6d& d = step.cameras[i];
    const CameraBlock& c = system.cameras[i];
    twice += d.cwiseAbs2().dot(DampingOf(c, lambda)) - d.dot(c.Gradient());
  }
  for (size_t j = 0; j < step.points.size(); ++j) {
    const Eigen::Vector3d& d = step.points[j];
    const PointBlock& block = system.points[j];
    const PointDamping damping = DampingOf(block.H, lambda);
    twice += d[0] * (damping.x * d[0] - block.g[0]) + d[1] * (damping.y * d[1] - block.g[1]) +
             d[2] * (damping.z * d[2] - block.g[2]);
  }
  return 0.5 * twice;
}

void SchurSolver::Solve(const Linearisation& system, double lambda, BundleStep& step) {
  ParallelFor(layout_.chunk_count(),
              [&](int chunk) { Eliminate(system, lambda, chunk, reduced_[chunk]); });
  AddCameras(system, lambda);
  Eigen::VectorXd x(6 * cameras_);
  for (int i = 0; i < cameras_; ++i) x.segment<6>(6 * i) = reduced_[0].right[i];
  step.valid = cameras_ == 0 || (sparse_ ? SolveSparse(x) : SolveDense(x));
  if (!step.valid || !x.allFinite()) {
    step.valid = false;
    return;
  }
  step.cameras.resize(cameras_);
  for (int i = 0; i < cameras_; ++i) step.cameras[i] = x.segment<6>(6 * i);
  Substitute(system, step);
  step.predicted = Predicted(system, lambda, step);
  step.valid = std::isfinite(step.predicted);
}

}  // namespace alidade
