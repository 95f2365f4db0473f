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

struct PointDamping {
  double x, y, z;
};
inline PointDamping DampingOf(const Symmetric3& H, double lambda) {
  const double largest = std::max({H[0], H[3], H[5]});
  return {Damping(lambda, H[0], largest), Damping(lambda, H[3], largest),
          Damping(lambda, H[5], largest)};
}

Vector6d DampingOf(const CameraBlock& block, double lambda) {
  const PointDamping t = DampingOf(block.tt, lambda), r = DampingOf(block.rr, lambda);
  Vector6d damping;
  damping << t.x, t.y, t.z, r.x, r.y, r.z;
  return damping;
}

using Factor = Eigen::Matrix<double, 6, 3>;

// G N L'^-1 of one coupling.
inline void MakeFactor(const Coupling& c, const double l[6], Factor& E) {
  const Symmetric3& N = c.N;
  const double n[3][3] = {{N[0], N[1], N[2]}, {N[1], N[3], N[4]}, {N[2], N[4], N[5]}};
  const double x = c.Y[0], y = c.Y[1], z = c.Y[2];
  for (int i = 0; i < 3; ++i) {
    E(i, 0) = n[i][0] * l[0];
    E(i, 1) = (n[i][1] - l[2] * E(i, 0)) * l[1];
    E(i, 2) = (n[i][2] - l[3] * E(i, 0) - l[4] * E(i, 1)) * l[5];
  }
  for (int j = 0; j < 3; ++j) {
    E(3, j) = y * E(2, j) - z * E(1, j);
    E(4, j) = z * E(0, j) - x * E(2, j);
    E(5, j) = x * E(1, j) - y * E(0, j);
  }
}

}  // namespace

SchurSolver::SchurSolver(const BundleLayout& layout, int sparse_above)
    : layout_(layout),
      sparse_(static_cast<int>(layout.free_cameras.size()) > sparse_above),
      cameras_(static_cast<int>(layout.free_cameras.size())),
      reduced_(layout.chunk_count()),
      eliminated_(layout.points.size()) {
  FindBlocks();
}

void SchurSolver::FindBlocks() {
  row_begin_.assign(cameras_ + 1, 0);
  if (!sparse_) {
    for (int row = 0; row < cameras_; ++row) row_begin_[row + 1] = row_begin_[row] + row + 1;
    return;
  }
  std::vector<std::vector<int>> columns(cameras_);
  for (const BundlePoint& point : layout_.points) {
    for (int a = point.begin; a < point.free_end; ++a) {
      std::vector<int>& row = columns[layout_.sightings[a].slot];
      for (int b = point.begin; b <= a; ++b) row.push_back(layout_.sightings[b].slot);
      // Keeps the list short: most of it is said again by every point.
      if (row.size() > 8192) {
        std::sort(row.begin(), row.end());
        row.erase(std::unique(row.begin(), row.end()), row.end());
      }
    }
  }
  for (int i = 0; i < cameras_; ++i) {
    std::vector<int>& row = columns[i];
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    column_.insert(column_.end(), row.begin(), row.end());
    row_begin_[i + 1] = static_cast<int>(column_.size());
  }
}

// `hint`: a block of the same row at or before the one looked for.
int SchurSolver::FindBlock(int row, int column, int hint) const {
  if (!sparse_) return row_begin_[row] + column;
  return static_cast<int>(
      std::lower_bound(column_.begin() + hint, column_.begin() + row_begin_[row + 1], column) -
      column_.begin());
}

void SchurSolver::Eliminate(const Linearisation& system, double lambda, int chunk,
                            Reduced& reduced) {
  reduced.blocks.assign(row_begin_[cameras_], Block::Zero());
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
      reduced.right[row] += E.col(0) * y0 + E.col(1) * y1 + E.col(2) * y2;
      int at = row_begin_[row];
      for (int b = 0; b <= a; ++b) {
        at = FindBlock(row, couplings[b].slot, at);
        Block& S = reduced.blocks[at];
        S.noalias() -= E.lazyProduct(factors[b].transpose());
        if (b < a && couplings[b].slot == row) {  // a point seen twice by one camera
          S.noalias() -= factors[b].lazyProduct(E.transpose());
        }
      }
    }
  }
}

void SchurSolver::AddCameras(const Linearisation& system, double lambda) {
  Reduced& sum = reduced_[0];
  for (size_t chunk = 1; chunk < reduced_.size(); ++chunk) {
    const Reduced& part = reduced_[chunk];
    for (size_t i = 0; i < sum.blocks.size(); ++i) sum.blocks[i] += part.blocks[i];
    for (int i = 0; i < cameras_; ++i) sum.right[i] += part.right[i];
  }
  for (int i = 0; i < cameras_; ++i) {
    const CameraBlock& c = system.cameras[i];
    Block& S = sum.blocks[row_begin_[i + 1] - 1];  // the last of a row is on the diagonal
    Block H;
    H.topLeftCorner<3, 3>() << c.tt[0], c.tt[1], c.tt[2], c.tt[1], c.tt[3], c.tt[4], c.tt[2],
        c.tt[4], c.tt[5];
    H.bottomLeftCorner<3, 3>() << c.rt[0], c.rt[1], c.rt[2], c.rt[3], c.rt[4], c.rt[5], c.rt[6],
        c.rt[7], c.rt[8];
    H.bottomRightCorner<3, 3>() << c.rr[0], c.rr[1], c.rr[2], c.rr[1], c.rr[3], c.rr[4], c.rr[2],
        c.rr[4], c.rr[5];
    H.topRightCorner<3, 3>() = H.bottomLeftCorner<3, 3>().transpose();
    H.diagonal() += DampingOf(c, lambda);
    S += H;
    sum.right[i] -= Eigen::Map<const Vector6d>(c.g.data());
  }
}

bool SchurSolver::SolveDense(Eigen::VectorXd& x) {
  const Reduced& reduced = reduced_[0];
  dense_.resize(6 * cameras_, 6 * cameras_);
  for (int row = 0, at = 0; row < cameras_; ++row) {
    for (int column = 0; column <= row; ++column, ++at) {
      dense_.block<6, 6>(6 * row, 6 * column) = reduced.blocks[at];
    }
  }
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);
  if (factor.info() != Eigen::Success) return false;
  factor.solveInPlace(x);
  return true;
}

bool SchurSolver::SolveSparse(Eigen::VectorXd& x) {
  const Reduced& reduced = reduced_[0];
  if (!analysed_) {
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(36 * column_.size());
    for (int row = 0; row < cameras_; ++row) {
      for (int at = row_begin_[row]; at < row_begin_[row + 1]; ++at) {
        for (int j = 0; j < 6; ++j) {
          for (int i = column_[at] == row ? j : 0; i < 6; ++i) {
            triplets.emplace_back(6 * row + i, 6 * column_[at] + j, 0.0);
          }
        }
      }
    }
    matrix_.resize(6 * cameras_, 6 * cameras_);
    matrix_.setFromTriplets(triplets.begin(), triplets.end());
    factor_.analyzePattern(matrix_);
    analysed_ = true;
  }
  // A column's rows ascend, and so do the block rows here: each column is filled from its top.
  std::vector<int> next(matrix_.outerIndexPtr(), matrix_.outerIndexPtr() + 6 * cameras_);
  double* values = matrix_.valuePtr();
  for (int row = 0; row < cameras_; ++row) {
    for (int at = row_begin_[row]; at < row_begin_[row + 1]; ++at) {
      for (int j = 0; j < 6; ++j) {
        int& to = next[6 * column_[at] + j];
        for (int i = column_[at] == row ? j : 0; i < 6; ++i)
          values[to++] = reduced.blocks[at](i, j);
      }
    }
  }
  factor_.factorize(matrix_);
  if (factor_.info() != Eigen::Success) return false;
  x = factor_.solve(x);
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
    const Vector6d g = Eigen::Map<const Vector6d>(system.cameras[i].g.data());
    twice += d.cwiseAbs2().dot(DampingOf(system.cameras[i], lambda)) - d.dot(g);
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
