// Cholesky factorization of a sparse symmetric matrix of square blocks, as in the reduced system of
// bundle adjustment (cameras that share points) or a pose graph (nodes that share an edge). Works
// on whole blocks in registers, where Eigen's sparse factorization works on single numbers.
// Left-looking, minimum-degree ordering (Davis 2006, §4.8, 7.1).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "alidade/optimize/double2.h"

namespace alidade {

// Column-major in pairs of rows; for an odd size the last row is padding.
template <int kSize>
struct SquareBlock {
  static constexpr int kPairs = (kSize + 1) / 2;
  Double2 column[kSize][kPairs];

  double operator()(int row, int col) const { return column[col][row / 2][row % 2]; }
  void Set(int row, int col, double value) { column[col][row / 2][row % 2] = value; }
  double* data() { return reinterpret_cast<double*>(column); }
  void Add(const SquareBlock& other) {
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kPairs; ++i) column[j][i] += other.column[j][i];
    }
  }
};

struct BlockPlace {  // position below the diagonal: row > column
  int row, column;
};

template <int kSize>
class BlockCholesky {
 public:
  using Block = SquareBlock<kSize>;

  // Sets the pattern: the nonzero blocks below the diagonal, each listed once. All diagonal blocks
  // are present.
  void Analyse(int block_rows, std::span<const BlockPlace> below);
  // Number of multiplications of one factorization.
  double Work() const { return work_; }

  // Sets the values before each Factorise(): Clear(), then block by block. `index` is that of the
  // block in Analyse().
  void Clear();
  void SetDiagonal(int block_row, const Block& block);
  void SetBelow(size_t index, const Block& block);

  // Returns false if the matrix is not positive definite.
  bool Factorise();
  void Solve(Eigen::VectorXd& x) const;  // in place
  // Blocks on the diagonal of the inverse, by block row. Twice the work of Factorise(): only the
  // blocks of the inverse where the factor has one are computed (Takahashi, Fagan & Chin 1973).
  std::vector<Block> InverseDiagonal() const;

 private:
  struct Source {  // block of the factor left of the diagonal, and the end of its column
    int at, column_end;
  };
  struct Target {
    int at;
    bool transposed;
  };

  int rows_ = 0;
  double work_ = 0;
  std::vector<int> order_;         // position of each block row in the factor
  std::vector<int> column_begin_;  // first block of each column of the factor: the diagonal one
  std::vector<int> row_;           // row of each block
  std::vector<int> source_begin_;
  std::vector<Source> sources_;  // ordered by row
  std::vector<Target> targets_;  // one per block below the matrix's diagonal
  std::vector<Block> blocks_;
  std::vector<int> block_of_row_;  // in the current column
};

extern template class BlockCholesky<6>;
extern template class BlockCholesky<7>;

}  // namespace alidade
