#include "alidade/optimize/bundle_schur.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "alidade/base/parallel.h"
#include "alidade/optimize/bundle_kernels.h"
#include "alidade/optimize/schur_row.h"

namespace alidade {
namespace {

// Measured ratio of time per multiplication: sparse to dense factorization.
constexpr double kSparseCost = 1.5;

void AddBlock(const Matrix6d& value, SquareBlock<6>& block) {
  for (int j = 0; j < 6; ++j) {
    for (int n = 0; n < 3; ++n) block.column[j][n] += Double2{value(2 * n, j), value(2 * n + 1, j)};
  }
}

}  // namespace

SchurSolver::SchurSolver(const BundleLayout& layout, ReducedFactor kind)
    : layout_(layout),
      sparse_(kind != ReducedFactor::kDense),
      cameras_(static_cast<int>(layout.free_cameras.size())),
      rows_(layout.rows()),
      reduced_(layout.chunk_count()),
      eliminated_(layout.points.size()) {
  FindBlocks();
  if (!sparse_) return;
  // If most cameras share points, the sparse factorization loses more by small blocks than it
  // saves.
  const double size = 6.0 * rows_, all_blocks = 0.5 * rows_ * (rows_ + 1.0);
  const bool may_pay = column_.size() < 0.5 * all_blocks;
  if (kind == ReducedFactor::kSparse || may_pay) Analyse();
  if (kind == ReducedFactor::kFastest &&
      !(may_pay && kSparseCost * factor_.Work() < size * size * size / 6)) {
    sparse_ = false;
    FindBlocks();
  }
}

double SchurSolver::Work() const {
  const double size = 6.0 * rows_;
  return sparse_ ? factor_.Work() : size * size * size / 6;
}

void SchurSolver::FindBlocks() {
  row_begin_.assign(rows_ + 1, 0);
  if (!sparse_) {
    for (int row = 0; row < rows_; ++row) row_begin_[row + 1] = row_begin_[row] + row + 1;
    return;
  }
  std::vector<uint8_t> together(static_cast<size_t>(rows_) * rows_, 0);
  for (const BundlePoint& point : layout_.points) {
    for (int a = point.begin; a < point.free_end; ++a) {
      uint8_t* row = together.data() + static_cast<size_t>(layout_.sightings[a].slot) * rows_;
      for (int b = point.begin; b <= a; ++b) row[layout_.sightings[b].slot] = 1;
    }
  }
  for (const BlockPlace& place : layout_.motion.blocks)
    together[static_cast<size_t>(place.row) * rows_ + place.column] = 1;
  for (int row = cameras_; row < rows_; ++row) together[static_cast<size_t>(row) * (rows_ + 1)] = 1;
  column_.clear();
  for (int i = 0; i < rows_; ++i) {
    const uint8_t* row = together.data() + static_cast<size_t>(i) * rows_;
    for (int j = 0; j <= i; ++j) {
      if (row[j]) column_.push_back(j);
    }
    row_begin_[i + 1] = static_cast<int>(column_.size());
  }
}

// `hint`: a block of the same row at or before the requested one.
inline int SchurSolver::FindBlock(int row, int column, int hint) const {
  if (!sparse_) return row_begin_[row] + column;
  // Cameras that share a point are mostly consecutive, so no block between them is missing: try the
  // position `column - column_[hint]` after the hint first.
  const int end = row_begin_[row + 1], guess = hint + column - column_[hint];
  if (guess < end && column_[guess] == column) return guess;
  return static_cast<int>(std::lower_bound(column_.begin() + hint, column_.begin() + end, column) -
                          column_.begin());
}

void SchurSolver::Eliminate(const Linearisation& system, double lambda, int chunk,
                            Reduced& reduced) {
  reduced.blocks.assign(row_begin_[rows_], SquareBlock<6>{});
  reduced.right.assign(rows_, Vector6d::Zero());
  std::vector<CouplingFactor> factors;
  std::vector<int> places;  // of the blocks of a row
  const SubtractRow subtract = FastestSubtractRow();
  for (int j = layout_.chunks[chunk]; j < layout_.chunks[chunk + 1]; ++j) {
    const BundlePoint& point = layout_.points[j];
    const PointBlock& block = system.points[j];
    const PointFactor L = FactorOf(block.H, DampingOf(block.H, lambda));
    eliminated_[j] = L;
    const std::array<double, 3> y = SolveLower(L, block.g);
    const int count = point.free_end - point.begin;
    if (static_cast<int>(factors.size()) < count) {
      factors.resize(count);
      places.resize(count);
    }
    const Coupling* couplings = system.couplings.data() + point.coupling;
    for (int a = 0; a < count; ++a) {
      CouplingFactor& E = factors[a];
      MakeFactor(couplings[a], L, E);
      const int row = couplings[a].slot;
      AddProduct(E, y, reduced.right[row]);
      int at = row_begin_[row];
      for (int b = 0; b <= a; ++b) places[b] = at = FindBlock(row, couplings[b].slot, at);
      subtract(E.column[0], factors[0].column[0], places.data(), a + 1, reduced.blocks[0].data());
      // The same camera observes the point more than once: both orders of the two.
      for (int b = a; b-- > 0 && couplings[b].slot == row;)
        SubtractProduct(factors[b], E, reduced.blocks[places[b]]);
    }
  }
}

void SchurSolver::AddCameras(const Linearisation& system, double lambda) {
  Reduced& sum = reduced_[0];
  for (size_t chunk = 1; chunk < reduced_.size(); ++chunk) {
    const Reduced& part = reduced_[chunk];
    for (size_t i = 0; i < sum.blocks.size(); ++i) sum.blocks[i].Add(part.blocks[i]);
    for (int i = 0; i < rows_; ++i) sum.right[i] += part.right[i];
  }
  for (int i = 0; i < cameras_; ++i) {
    const CameraBlock& c = system.cameras[i];
    AddDiagonal(i, c.Hessian(), DampingOf(c, lambda), c.Gradient());
  }
}

void SchurSolver::AddDiagonal(int row, Matrix6d H, const Vector6d& damping, const Vector6d& g) {
  H.diagonal() += damping;
  // The last block of a row is on the diagonal.
  AddBlock(H, reduced_[0].blocks[row_begin_[row + 1] - 1]);
  reduced_[0].right[row] -= g;
}

void SchurSolver::AddMotion(const Linearisation& system, double lambda) {
  const std::vector<BlockPlace>& places = layout_.motion.blocks;
  for (size_t i = 0; i < places.size(); ++i) {
    const auto [row, column] = places[i];
    AddBlock(system.motion[i], reduced_[0].blocks[FindBlock(row, column, row_begin_[row])]);
  }
  for (size_t k = 0; k < system.states.size(); ++k) {
    const StateBlock& state = system.states[k];
    AddDiagonal(cameras_ + static_cast<int>(k), state.H, DampingOf(state, lambda), state.g);
  }
}

void SchurSolver::FillDense() {
  const Reduced& reduced = reduced_[0];
  dense_.resize(6 * rows_, 6 * rows_);
  for (int row = 0, at = 0; row < rows_; ++row) {
    for (int column = 0; column <= row; ++column, ++at) {
      for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < 6; ++i) dense_(6 * row + i, 6 * column + j) = reduced.blocks[at](i, j);
      }
    }
  }
}

bool SchurSolver::SolveDense(Eigen::VectorXd& x) {
  FillDense();
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);
  if (factor.info() != Eigen::Success) return false;
  factor.solveInPlace(x);
  return true;
}

void SchurSolver::Analyse() {
  std::vector<BlockPlace> below;
  for (int row = 0; row < rows_; ++row) {
    for (int at = row_begin_[row]; at + 1 < row_begin_[row + 1]; ++at) {
      below.push_back({row, column_[at]});
    }
  }
  factor_.Analyse(rows_, below);
}

bool SchurSolver::FactorSparse() {
  const Reduced& reduced = reduced_[0];
  factor_.Clear();
  size_t below = 0;
  for (int row = 0; row < rows_; ++row) {
    const int diagonal = row_begin_[row + 1] - 1;
    for (int at = row_begin_[row]; at < diagonal; ++at) {
      factor_.SetBelow(below++, reduced.blocks[at]);
    }
    factor_.SetDiagonal(row, reduced.blocks[diagonal]);
  }
  return factor_.Factorise();
}

bool SchurSolver::SolveSparse(Eigen::VectorXd& x) {
  if (!FactorSparse()) return false;
  factor_.Solve(x);
  return true;
}

// Points: (H + D) δ = -g - Σ N G' δ_camera.
void SchurSolver::Substitute(const Linearisation& system, BundleStep& step) {
  step.points.resize(layout_.points.size());
  ParallelFor(layout_.chunk_count(), [&](int chunk) {
    for (int j = layout_.chunks[chunk]; j < layout_.chunks[chunk + 1]; ++j) {
      const BundlePoint& point = layout_.points[j];
      const PointBlock& block = system.points[j];
      std::array<double, 3> r = {-block.g[0], -block.g[1], -block.g[2]};
      const Coupling* c = system.couplings.data() + point.coupling;
      for (int n = point.free_end - point.begin; n > 0; --n, ++c) {
        SubtractStep(*c, step.cameras[c->slot], r);
      }
      const PointFactor& L = eliminated_[j];
      step.points[j] = SolveUpper(L, SolveLower(L, r));
    }
  });
}

// ½ (δ' D δ - g' δ), which equals -g' δ - ½ δ' H δ because (H + D) δ = -g.
double SchurSolver::Predicted(const Linearisation& system, double lambda,
                              const BundleStep& step) const {
  double twice = 0;
  for (int i = 0; i < cameras_; ++i) {
    const Vector6d& d = step.cameras[i];
    const CameraBlock& c = system.cameras[i];
    twice += d.cwiseAbs2().dot(DampingOf(c, lambda)) - d.dot(c.Gradient());
  }
  for (size_t k = 0; k < step.states.size(); ++k) {
    const Vector6d& d = step.states[k];
    const StateBlock& state = system.states[k];
    twice += d.cwiseAbs2().dot(DampingOf(state, lambda)) - d.dot(state.g);
  }
  for (size_t j = 0; j < step.points.size(); ++j) {
    const Eigen::Vector3d& d = step.points[j];
    const PointBlock& block = system.points[j];
    const std::array<double, 3> damping = DampingOf(block.H, lambda);
    twice += d[0] * (damping[0] * d[0] - block.g[0]) + d[1] * (damping[1] * d[1] - block.g[1]) +
             d[2] * (damping[2] * d[2] - block.g[2]);
  }
  return 0.5 * twice;
}

void SchurSolver::Reduce(const Linearisation& system, double lambda) {
  ParallelFor(layout_.chunk_count(),
              [&](int chunk) { Eliminate(system, lambda, chunk, reduced_[chunk]); });
  AddCameras(system, lambda);
  AddMotion(system, lambda);
}

bool SchurSolver::Covariance(const Linearisation& system, int slot, const Eigen::VectorXd& held,
                             Matrix6d& covariance) {
  constexpr double kNoDamping = 0;  // but DampingOfEntry()'s for directions nothing observes
  Reduce(system, kNoDamping);
  FillDense();
  if (held.size() > 0 && held.squaredNorm() > 0) {
    // As if the step along `held` were observed, more precisely than any other.
    const double weight = 10 * dense_.diagonal().maxCoeff() / held.squaredNorm();
    for (Eigen::Index j = 0; j < dense_.cols(); ++j) {
      const Eigen::Index below = dense_.rows() - j;
      dense_.col(j).tail(below) += weight * held[j] * held.tail(below);
    }
  }
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);
  if (factor.info() != Eigen::Success) return false;
  Eigen::VectorXd column(6 * rows_);
  for (int j = 0; j < 6; ++j) {
    column.setZero();
    column[6 * slot + j] = 1;
    factor.solveInPlace(column);
    covariance.col(j) = column.segment<6>(6 * slot);
  }
  return covariance.allFinite();
}

bool SchurSolver::Factor(const Linearisation& system, const std::vector<int>& held) {
  Reduce(system, 0);
  double largest = 0;
  for (int row = 0; row < rows_; ++row) {
    const SquareBlock<6>& block = reduced_[0].blocks[row_begin_[row + 1] - 1];
    for (int i = 0; i < 6; ++i) largest = std::max(largest, block(i, i));
  }
  for (const int number : held) {
    SquareBlock<6>& block = reduced_[0].blocks[row_begin_[number / 6 + 1] - 1];
    block.Set(number % 6, number % 6, block(number % 6, number % 6) + largest);
  }
  if (sparse_) return FactorSparse();
  FillDense();
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);
  return factor.info() == Eigen::Success;
}

void SchurSolver::SolveFactored(Eigen::VectorXd& x) const {
  if (sparse_) {
    factor_.Solve(x);
    return;
  }
  dense_.triangularView<Eigen::Lower>().solveInPlace(x);
  dense_.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
}

std::vector<Matrix6d> SchurSolver::InverseDiagonal() const {
  std::vector<Matrix6d> diagonal(rows_);
  if (sparse_) {
    const std::vector<SquareBlock<6>> blocks = factor_.InverseDiagonal();
    for (int row = 0; row < rows_; ++row) {
      for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < 6; ++i) diagonal[row](i, j) = blocks[row](i, j);
      }
    }
    return diagonal;
  }
  for (int row = 0; row < rows_; ++row) {  // (L⁻¹)' L⁻¹, of which the columns begin at the row
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(6 * (rows_ - row), 6);
    columns.topRows<6>().setIdentity();
    dense_.bottomRightCorner(columns.rows(), columns.rows())
        .triangularView<Eigen::Lower>()
        .solveInPlace(columns);
    diagonal[row] = columns.transpose() * columns;
  }
  return diagonal;
}

void SchurSolver::Solve(const Linearisation& system, double lambda, BundleStep& step) {
  Reduce(system, lambda);
  Eigen::VectorXd x(6 * rows_);
  for (int i = 0; i < rows_; ++i) x.segment<6>(6 * i) = reduced_[0].right[i];
  step.valid = rows_ == 0 || (sparse_ ? SolveSparse(x) : SolveDense(x));
  if (!step.valid || !x.allFinite()) {
    step.valid = false;
    return;
  }
  step.cameras.resize(cameras_);
  for (int i = 0; i < cameras_; ++i) step.cameras[i] = x.segment<6>(6 * i);
  step.states.resize(rows_ - cameras_);
  for (int i = cameras_; i < rows_; ++i) step.states[i - cameras_] = x.segment<6>(6 * i);
  Substitute(system, step);
  step.predicted = Predicted(system, lambda, step);
  step.valid = std::isfinite(step.predicted);
}

}  // namespace alidade
