// One damped Gauss–Newton step of bundle adjustment: eliminates the points, solves the reduced
// camera system dense or sparse, and back-substitutes the points (Triggs et al. 2000, §6.1).
#pragma once

#include <vector>

#include "alidade/optimize/block_cholesky.h"
#include "alidade/optimize/bundle_kernels.h"
#include "alidade/optimize/bundle_linearise.h"

namespace alidade {

struct BundleStep {
  std::vector<Vector6d> cameras;        // (ρ, θ) by slot
  std::vector<Vector6d> states;         // (velocity, bias) of the inertial sensor
  std::vector<Eigen::Vector3d> points;  // in the layout's order
  double predicted = 0;                 // decrease of the cost in the quadratic model
  bool valid = false;                   // false: the system could not be factored
};

enum class ReducedFactor { kDense, kSparse, kFastest };

// Keeps what is constant between steps: the nonzero blocks of the reduced system and the
// elimination order.
class SchurSolver {
 public:
  SchurSolver(const BundleLayout& layout, ReducedFactor kind);
  bool sparse() const { return sparse_; }
  double Work() const;  // number of multiplications of one factorization
  void Solve(const Linearisation& system, double lambda, BundleStep& step);
  // Covariance of the step of one free camera: its block of the inverse of the reduced system.
  // `held`: a direction of the step of all rows that is held, because no observation determines
  // it; may be empty. Only for ReducedFactor::kDense. Returns false if the system is singular.
  bool Covariance(const Linearisation& system, int slot, const Eigen::VectorXd& held,
                  Matrix6d& covariance);

  // Factors the reduced system without damping. `held`: numbers of the step that are held, because
  // no observation determines them. Returns false if the system is singular.
  bool Factor(const Linearisation& system, const std::vector<int>& held);
  // After Factor(): x <- inverse of the reduced system times x.
  void SolveFactored(Eigen::VectorXd& x) const;
  // After Factor(): the blocks on the diagonal of the inverse.
  std::vector<Matrix6d> InverseDiagonal() const;

 private:
  struct Reduced {  // lower blocks of the reduced system, and its right-hand side
    std::vector<SquareBlock<6>> blocks;  // row by row, in ascending columns
    std::vector<Vector6d> right;
  };

  void FindBlocks();
  void Analyse();
  int FindBlock(int row, int column, int hint) const;
  void Eliminate(const Linearisation& system, double lambda, int chunk, Reduced& reduced);
  void AddCameras(const Linearisation& system, double lambda);
  void AddDiagonal(int row, Matrix6d H, const Vector6d& damping, const Vector6d& g);
  void AddMotion(const Linearisation& system, double lambda);
  void Reduce(const Linearisation& system, double lambda);  // into reduced_[0]
  void FillDense();
  bool SolveDense(Eigen::VectorXd& x);
  bool FactorSparse();
  bool SolveSparse(Eigen::VectorXd& x);
  void Substitute(const Linearisation& system, BundleStep& step);
  double Predicted(const Linearisation& system, double lambda, const BundleStep& step) const;

  const BundleLayout& layout_;
  bool sparse_;
  int cameras_;
  int rows_;                      // of blocks: free cameras, then states of the inertial sensor
  std::vector<int> row_begin_;    // first block of each block row
  std::vector<int> column_;       // column of each block
  std::vector<Reduced> reduced_;  // one per chunk; the first holds the sum
  std::vector<PointFactor> eliminated_;  // factor of each point's damped H
  Eigen::MatrixXd dense_;
  BlockCholesky<6> factor_;
};

}  // namespace alidade
