#include "alidade/optimize/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <set>
#include <utility>

#include "alidade/base/random.h"

namespace alidade::block_cholesky_test {
namespace {

template <int kSize>
SquareBlock<kSize> BlockOf(const Eigen::MatrixXd& m, int row, int column) {
  SquareBlock<kSize> block{};
  for (int j = 0; j < kSize; ++j) {
    for (int i = 0; i < kSize; ++i) block.Set(i, j, m(kSize * row + i, kSize * column + j));
  }
  return block;
}

// A positive definite matrix with diagonal blocks, `ties` random blocks, and a closed chain.
template <int kSize>
struct Problem {
  Problem(int rows, int ties, uint64_t seed) : matrix(kSize * rows, kSize * rows) {
    Random random(seed);
    std::set<std::pair<int, int>> pairs;
    for (int i = 0; i < rows && rows > 1; ++i) pairs.insert(std::minmax({i, (i + 1) % rows}));
    for (int i = 0; i < ties; ++i) {
      const int a = static_cast<int>(random.Below(rows)), b = static_cast<int>(random.Below(rows));
      if (a != b) pairs.insert(std::minmax({a, b}));
    }
    matrix.setZero();
    for (const auto& [low, high] : pairs) {
      below.push_back({high, low});
      Eigen::MatrixXd J(kSize, 2 * kSize);  // Jacobian of an edge
      for (int i = 0; i < J.size(); ++i) J.data()[i] = random.Gaussian();
      const Eigen::MatrixXd H = J.transpose() * J;
      const int at[2] = {kSize * low, kSize * high};
      for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) {
          matrix.block<kSize, kSize>(at[i], at[j]) += H.block<kSize, kSize>(kSize * i, kSize * j);
        }
      }
    }
    matrix.diagonal().array() += 0.1;
    // In random order.
    for (size_t i = below.size(); i > 1; --i) {
      std::swap(below[i - 1], below[random.Below(static_cast<uint32_t>(i))]);
    }
    right = Eigen::VectorXd::Zero(kSize * rows);
    for (double& value : right) value = random.Gaussian();
  }

  bool Solve(BlockCholesky<kSize>& factor, Eigen::VectorXd& x) const {
    factor.Clear();
    for (int i = 0; i < matrix.rows() / kSize; ++i) {
      factor.SetDiagonal(i, BlockOf<kSize>(matrix, i, i));
    }
    for (size_t i = 0; i < below.size(); ++i) {
      factor.SetBelow(i, BlockOf<kSize>(matrix, below[i].row, below[i].column));
    }
    x = right;
    if (!factor.Factorise()) return false;
    factor.Solve(x);
    return true;
  }

  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  std::vector<BlockPlace> below;
};

template <int kSize>
void ExpectSolved(int rows, int ties, uint64_t seed) {
  Problem<kSize> problem(rows, ties, seed);
  BlockCholesky<kSize> factor;
  factor.Analyse(rows, problem.below);
  for (const double scale : {1.0, 3.0}) {  // the second pass reuses the memory of the first
    problem.matrix *= scale;
    Eigen::VectorXd x;
    ASSERT_TRUE(problem.Solve(factor, x));
    const Eigen::VectorXd expected = problem.matrix.ldlt().solve(problem.right);
    EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm()) << rows << " " << ties;
  }
}

TEST(BlockCholesky, SolvesWhatTheDenseFactorSolves) {
  for (const int rows : {1, 2, 3, 10, 40}) {
    for (const int ties : {0, 5, 60, 2000}) {
      ExpectSolved<6>(rows, ties, 1);
      ExpectSolved<7>(rows, ties, 2);
    }
  }
}

TEST(BlockCholesky, HasTheDiagonalOfTheInverse) {
  const Problem<6> problem(40, 60, 7);
  BlockCholesky<6> factor;
  factor.Analyse(40, problem.below);
  Eigen::VectorXd x;
  ASSERT_TRUE(problem.Solve(factor, x));
  const Eigen::MatrixXd inverse = problem.matrix.inverse();
  const std::vector<SquareBlock<6>> found = factor.InverseDiagonal();
  for (int row = 0; row < 40; ++row) {
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i)
        EXPECT_NEAR(found[row](i, j), inverse(6 * row + i, 6 * row + j), 1e-9);
    }
  }
}

TEST(BlockCholesky, SaysWhenTheMatrixIsNotPositiveDefinite) {
  Problem<6> problem(12, 10, 3);
  BlockCholesky<6> factor;
  factor.Analyse(12, problem.below);
  Eigen::VectorXd x;
  const Eigen::MatrixXd good = problem.matrix;
  problem.matrix(50, 50) = -1;
  EXPECT_FALSE(problem.Solve(factor, x));
  problem.matrix(50, 50) = std::nan("");
  EXPECT_FALSE(problem.Solve(factor, x));
  problem.matrix = good;
  EXPECT_TRUE(problem.Solve(factor, x));
}

TEST(BlockCholesky, AClosedChainFillsNoMoreThanOneFurtherRow) {
  std::vector<BlockPlace> chain;
  for (int i = 1; i < 1000; ++i) chain.push_back({i, i - 1});
  chain.push_back({999, 0});
  BlockCholesky<6> factor;
  factor.Analyse(1000, chain);
  EXPECT_LE(factor.Work(), 1000 * 6 * 6 * 6 * 6);  // 2 blocks below the diagonal: (3 · 4) / 2
}

}  // namespace
}  // namespace alidade::block_cholesky_test
