#include "alidade/optimize/block_cholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

// Position of each block row: approximate minimum degree ordering of the block pattern.
std::vector<int> MinimumDegree(int rows, std::span<const BlockPlace> below) {
  std::vector<Eigen::Triplet<double>> triplets;
  for (int i = 0; i < rows; ++i) triplets.emplace_back(i, i, 1.0);
  for (const BlockPlace& place : below) {
    triplets.emplace_back(place.row, place.column, 1.0);
    triplets.emplace_back(place.column, place.row, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(rows, rows);
  pattern.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(pattern, permutation);
  std::vector<int> order(rows);
  for (int i = 0; i < rows; ++i) order[permutation.indices()[i]] = i;
  return order;
}

// kColumns columns of C -= A B', starting at the even column j; as many as fit in registers.
template <int kColumns, int kSize>
[[gnu::always_inline]] inline void SubtractColumns(const SquareBlock<kSize>& A,
                                                   const SquareBlock<kSize>& B, int j,
                                                   SquareBlock<kSize>& C) {
  constexpr int kPairs = SquareBlock<kSize>::kPairs;
  Double2 sum[kColumns][kPairs];
#pragma GCC unroll 2
  for (int c = 0; c < kColumns; ++c) {
#pragma GCC unroll 4
    for (int i = 0; i < kPairs; ++i) sum[c][i] = C.column[j + c][i];
  }
#pragma GCC unroll 8
  for (int k = 0; k < kSize; ++k) {
    const Double2 b = B.column[k][j / 2];
#pragma GCC unroll 2
    for (int c = 0; c < kColumns; ++c) {
#pragma GCC unroll 4
      for (int i = 0; i < kPairs; ++i) sum[c][i] -= A.column[k][i] * Both(b[c]);
    }
  }
#pragma GCC unroll 2
  for (int c = 0; c < kColumns; ++c) {
#pragma GCC unroll 4
    for (int i = 0; i < kPairs; ++i) C.column[j + c][i] = sum[c][i];
  }
}

template <int kSize>
[[gnu::always_inline]] inline void Subtract(const SquareBlock<kSize>& A,
                                            const SquareBlock<kSize>& B, SquareBlock<kSize>& C) {
  for (int j = 0; j + 1 < kSize; j += 2) SubtractColumns<2>(A, B, j, C);
  if constexpr (kSize % 2 != 0) SubtractColumns<1>(A, B, kSize - 1, C);
}

// Replaces the lower half by L of L L', with inverted diagonal. Returns false if not positive
// definite.
template <int kSize>
bool FactoriseDense(SquareBlock<kSize>& block) {
  double a[kSize][kSize];
  for (int j = 0; j < kSize; ++j) {
    for (int i = j; i < kSize; ++i) a[i][j] = block(i, j);
  }
  for (int j = 0; j < kSize; ++j) {
    double pivot = a[j][j];
    for (int k = 0; k < j; ++k) pivot -= a[j][k] * a[j][k];
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    a[j][j] = 1 / std::sqrt(pivot);
    for (int i = j + 1; i < kSize; ++i) {
      double sum = a[i][j];
      for (int k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = sum * a[j][j];
    }
  }
  for (int j = 0; j < kSize; ++j) {
    for (int i = j; i < kSize; ++i) block.Set(i, j, a[i][j]);
  }
  return true;
}

// X <- X L'^-1
template <int kSize>
void SolveRight(const SquareBlock<kSize>& L, SquareBlock<kSize>& X) {
  for (int j = 0; j < kSize; ++j) {
    for (Double2& x : X.column[j]) x *= Both(L(j, j));
    for (int k = j + 1; k < kSize; ++k) {
      for (int i = 0; i < SquareBlock<kSize>::kPairs; ++i) {
        X.column[k][i] -= X.column[j][i] * Both(L(k, j));
      }
    }
  }
}

}  // namespace

template <int kSize>
void BlockCholesky<kSize>::Analyse(int block_rows, std::span<const BlockPlace> below) {
  rows_ = block_rows;
  order_ = MinimumDegree(rows_, below);
  std::vector<std::vector<int>> columns(rows_);  // rows below the diagonal, by column
  for (const BlockPlace& place : below) {
    const auto [low, high] = std::minmax({order_[place.row], order_[place.column]});
    columns[low].push_back(high);
  }
  // Fill-in: the rows of a column are added to the column of its first row (its parent in the
  // elimination tree).
  for (std::vector<int>& rows : columns) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    if (rows.empty()) continue;
    std::vector<int>& parent = columns[rows.front()];
    parent.insert(parent.end(), rows.begin() + 1, rows.end());
  }

  column_begin_.assign(1, 0);
  row_.clear();
  source_begin_.assign(rows_ + 2, 0);
  work_ = 0;
  for (int j = 0; j < rows_; ++j) {
    row_.push_back(j);
    row_.insert(row_.end(), columns[j].begin(), columns[j].end());
    column_begin_.push_back(static_cast<int>(row_.size()));
    for (const int row : columns[j]) ++source_begin_[row + 2];
    const double count = static_cast<double>(columns[j].size());
    work_ += 0.5 * (count + 1) * (count + 2) * kSize * kSize * kSize;
  }
  for (int i = 0; i < rows_; ++i) source_begin_[i + 2] += source_begin_[i + 1];
  sources_.resize(row_.size() - static_cast<size_t>(rows_));
  for (int j = 0; j < rows_; ++j) {
    for (int at = column_begin_[j] + 1; at < column_begin_[j + 1]; ++at) {
      sources_[source_begin_[row_[at] + 1]++] = {at, column_begin_[j + 1]};
    }
  }

  targets_.clear();
  for (const BlockPlace& place : below) {
    const auto [low, high] = std::minmax({order_[place.row], order_[place.column]});
    const auto found = std::lower_bound(row_.begin() + column_begin_[low],
                                        row_.begin() + column_begin_[low + 1], high);
    targets_.push_back({static_cast<int>(found - row_.begin()), order_[place.row] == low});
  }
  blocks_.resize(row_.size());
  block_of_row_.resize(rows_);
}

template <int kSize>
void BlockCholesky<kSize>::Clear() {
  std::fill(blocks_.begin(), blocks_.end(), Block{});
}

template <int kSize>
void BlockCholesky<kSize>::SetDiagonal(int block_row, const Block& block) {
  blocks_[column_begin_[order_[block_row]]] = block;
}

template <int kSize>
void BlockCholesky<kSize>::SetBelow(size_t index, const Block& block) {
  const Target& target = targets_[index];
  Block& to = blocks_[target.at];
  if (!target.transposed) {
    to = block;
    return;
  }
  for (int j = 0; j < kSize; ++j) {
    for (int i = 0; i < kSize; ++i) to.Set(i, j, block(j, i));
  }
}

template <int kSize>
bool BlockCholesky<kSize>::Factorise() {
  for (int j = 0; j < rows_; ++j) {
    const int begin = column_begin_[j], end = column_begin_[j + 1];
    for (int at = begin; at < end; ++at) block_of_row_[row_[at]] = at;
    for (int s = source_begin_[j]; s < source_begin_[j + 1]; ++s) {
      const Source& source = sources_[s];
      const Block B = blocks_[source.at];
      for (int at = source.at; at < source.column_end; ++at) {
        Subtract(blocks_[at], B, blocks_[block_of_row_[row_[at]]]);
      }
    }
    Block& diagonal = blocks_[begin];
    if (!FactoriseDense(diagonal)) return false;
    for (int at = begin + 1; at < end; ++at) SolveRight(diagonal, blocks_[at]);
  }
  return true;
}

template <int kSize>
void BlockCholesky<kSize>::Solve(Eigen::VectorXd& x) const {
  using Vector = Eigen::Matrix<double, kSize, 1>;
  std::vector<Vector> y(rows_);
  for (int i = 0; i < rows_; ++i) y[order_[i]] = x.segment<kSize>(kSize * i);
  for (int j = 0; j < rows_; ++j) {
    const Block& L = blocks_[column_begin_[j]];
    Vector& v = y[j];
    for (int k = 0; k < kSize; ++k) {
      v[k] *= L(k, k);
      for (int i = k + 1; i < kSize; ++i) v[i] -= L(i, k) * v[k];
    }
    for (int at = column_begin_[j] + 1; at < column_begin_[j + 1]; ++at) {
      const Block& B = blocks_[at];
      Vector& to = y[row_[at]];
      for (int k = 0; k < kSize; ++k) {
        for (int i = 0; i < kSize; ++i) to[i] -= B(i, k) * v[k];
      }
    }
  }
  for (int j = rows_ - 1; j >= 0; --j) {
    const Block& L = blocks_[column_begin_[j]];
    Vector& v = y[j];
    for (int at = column_begin_[j] + 1; at < column_begin_[j + 1]; ++at) {
      const Block& B = blocks_[at];
      const Vector& from = y[row_[at]];
      for (int k = 0; k < kSize; ++k) {
        for (int i = 0; i < kSize; ++i) v[k] -= B(i, k) * from[i];
      }
    }
    for (int k = kSize - 1; k >= 0; --k) {
      for (int i = k + 1; i < kSize; ++i) v[k] -= L(i, k) * v[i];
      v[k] *= L(k, k);
    }
  }
  for (int i = 0; i < rows_; ++i) x.segment<kSize>(kSize * i) = y[order_[i]];
}

// With A = L L' and Z = A⁻¹, Z L = L'⁻¹ is zero below the diagonal: Z_ij = -(sum over k > j of
// Z_ik L_kj) L_jj⁻¹, and Z_jj = (L_jj'⁻¹ - sum over k > j of Z_kj' L_kj) L_jj⁻¹.
template <int kSize>
std::vector<SquareBlock<kSize>> BlockCholesky<kSize>::InverseDiagonal() const {
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  const auto dense = [](const Block& block) {
    Matrix matrix;
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) matrix(i, j) = block(i, j);
    }
    return matrix;
  };
  std::vector<Matrix> inverse(row_.size());
  std::vector<Matrix> factor;  // of the column below the diagonal
  for (int j = rows_; j-- > 0;) {
    const int begin = column_begin_[j] + 1, count = column_begin_[j + 1] - begin;
    Matrix L = dense(blocks_[begin - 1]).template triangularView<Eigen::Lower>();
    L.diagonal() = L.diagonal().cwiseInverse().eval();
    const Matrix to_right = L.template triangularView<Eigen::Lower>().solve(Matrix::Identity());
    factor.resize(count);
    for (int k = 0; k < count; ++k) {
      factor[k] = dense(blocks_[begin + k]);
      inverse[begin + k].setZero();
    }
    for (int k = 0; k < count; ++k) {  // the blocks Z_ik, i >= k, are those of column k
      const int column = row_[begin + k];
      int at = column_begin_[column];
      inverse[begin + k].noalias() -= inverse[at] * factor[k];
      for (int i = k + 1; i < count; ++i) {
        while (row_[at] != row_[begin + i]) ++at;
        inverse[begin + i].noalias() -= inverse[at] * factor[k];
        inverse[begin + k].noalias() -= inverse[at].transpose() * factor[i];
      }
    }
    Matrix own = to_right.transpose();
    for (int k = 0; k < count; ++k) {
      inverse[begin + k] = (inverse[begin + k] * to_right).eval();
      own.noalias() -= inverse[begin + k].transpose() * factor[k];
    }
    inverse[begin - 1] = own * to_right;
  }
  std::vector<Block> diagonal(rows_);
  for (int row = 0; row < rows_; ++row) {
    const Matrix& of_row = inverse[column_begin_[order_[row]]];
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) diagonal[row].Set(i, j, of_row(i, j));
    }
  }
  return diagonal;
}

template class BlockCholesky<6>;
template class BlockCholesky<7>;

}  // namespace alidade
