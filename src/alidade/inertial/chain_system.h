// Normal equations of a chain of states with a few common parameters: block tridiagonal with a
// border. Solved by block Cholesky elimination along the chain, in time linear in its length.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

class ChainSystem {
 public:
  static constexpr int kState = 15, kCommon = 10;
  using StateMatrix = Eigen::Matrix<double, kState, kState>;
  using StateVector = Eigen::Matrix<double, kState, 1>;
  using BorderMatrix = Eigen::Matrix<double, kState, kCommon>;
  using CommonMatrix = Eigen::Matrix<double, kCommon, kCommon>;
  using CommonVector = Eigen::Matrix<double, kCommon, 1>;
  using JointMatrix = Eigen::Matrix<double, kState + kCommon, kState + kCommon>;

  explicit ChainSystem(int states) : links_(states) {}

  // Adds the squared residual |r + A_k x_k + A_next x_(k+1) + C c|² with weighted (whitened)
  // residual and derivatives; `by_next` may be null.
  template <int N>
  void Add(int k, const Eigen::Matrix<double, N, 1>& r,
           const Eigen::Matrix<double, N, kState>& by_state,
           const Eigen::Matrix<double, N, kState>* by_next,
           const Eigen::Matrix<double, N, kCommon>& by_common) {
    Link& at = links_[k];
    at.diagonal.noalias() += by_state.transpose() * by_state;
    at.border.noalias() += by_state.transpose() * by_common;
    at.right -= by_state.transpose() * r;
    if (by_next) {
      Link& next = links_[k + 1];
      at.next.noalias() += by_state.transpose() * *by_next;
      next.diagonal.noalias() += by_next->transpose() * *by_next;
      next.border.noalias() += by_next->transpose() * by_common;
      next.right -= by_next->transpose() * r;
    }
    common_.noalias() += by_common.transpose() * by_common;
    common_right_ -= by_common.transpose() * r;
    cost_ += r.squaredNorm();
    residuals_ += N;
  }
  // Prior of one common parameter: `weight` (c + value)².
  void AddCommon(int index, double value, double weight);

  struct Solution {
    bool ok = false;  // the matrix is positive definite
    std::vector<StateVector> states;
    CommonVector common = CommonVector::Zero();
    JointMatrix last_covariance = JointMatrix::Zero();  // of (last state; common)
  };
  // The same chain from its last state to its first.
  ChainSystem Reversed() const;
  // Solves with `damping` times the diagonal added to it. Destroys the system.
  Solution Solve(double damping);
  double cost() const { return cost_; }
  int residuals() const { return residuals_; }

 private:
  struct Link {
    StateMatrix diagonal = StateMatrix::Zero();
    StateMatrix next = StateMatrix::Zero();  // rows: this state, columns: the next one
    BorderMatrix border = BorderMatrix::Zero();
    StateVector right = StateVector::Zero();
  };
  std::vector<Link> links_;
  CommonMatrix common_ = CommonMatrix::Zero();
  CommonVector common_right_ = CommonVector::Zero();
  double cost_ = 0;
  int residuals_ = 0;
};

}  // namespace alidade
