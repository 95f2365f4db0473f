// Cholesky factor of a sparse symmetric matrix made of square blocks: cameras that see the same
// points, nodes that share an edge. What Eigen's sparse factor does number by number is done block
// by block here, in registers. Left-looking, ordered by minimum degree (Davis 2006, §4.8, 7.1).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "alidade/optimize/double2.h"

namespace alidade {

// Column by column, two rows at a time; with an odd size the last row is padding.
template <int kSize>
struct SquareBlock {
  static constexpr int kPairs = (kSize + 1) / 2;
  Double2 column[kSize][kPairs];

  double operator()(int row, int col) const { return column[col][row / 2][row % 2]; }
  void Set(int row, int col, double value) { column[col][row / 2][row % 2] = value; }
  void Add(const SquareBlock& other) {
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kPairs; ++i) column[j][i] += other.column[j][i];
    }
  }
};

struct BlockPlace {  // below the diagonal: row > column
  int row, column;
};

template <int kSize>
class BlockCholesky {
 public:
  using Block = SquareBlock<kSize>;

  // Which blocks below the diagonal are not zero, each named once; all on the diagonal are there.
  void Analyse(int block_rows, std::span<const BlockPlace> below);
  // Multiplications of one factorisation.
  double Work() const { return work_; }

  // The matrix, anew before each Factorise: cleared, then block by block. `index`: as given to
  // Analyse.
  void Clear();
  void SetDiagonal(int block_row, const Block& block);
  void SetBelow(size_t index, const Block& block);

  // False: not positive definite.
  bool Factorise();
  void Solve(Eigen::VectorXd& x) const;  // in place

 private:
  struct Source {  // a block of the factor left of the diagonal, and the column it is in
    int at, column_end;
  };
  struct Target {
    int at;
    bool transposed;
  };

  int rows_ = 0;
  double work_ = 0;
  std::vector<int> order_;         // place of each block row in the factor
  std::vector<int> column_begin_;  // first block of each column of the factor: the diagonal one
  std::vector<int> row_;           // of each block
  std::vector<int> source_begin_;
  std::vector<Source> sources_;  // row by row
  std::vector<Target> targets_;  // of the blocks below the matrix's diagonal
  std::vector<Block> blocks_;
  std::vector<int> block_of_row_;  // in the column under work
};

extern template class BlockCholesky<6>;
extern template class BlockCholesky<7>;

}  // namespace alidade
