#include "alidade/inertial/chain_system.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace alidade {

void ChainSystem::AddCommon(int index, double value, double weight) {
  common_(index, index) += weight;
  common_right_(index) -= weight * value;
  cost_ += weight * value * value;
}

ChainSystem ChainSystem::Reversed() const {
  ChainSystem other = *this;
  std::reverse(other.links_.begin(), other.links_.end());
  const size_t count = links_.size();
  for (size_t k = 0; k + 1 < count; ++k)
    other.links_[k].next = links_[count - 2 - k].next.transpose();
  return other;
}

ChainSystem::Solution ChainSystem::Solve(double damping) {
  Solution solution;
  const size_t count = links_.size();
  for (Link& link : links_) link.diagonal.diagonal() *= 1 + damping;
  common_.diagonal() *= 1 + damping;

  // Forward: each state in terms of the next one and of the common parameters.
  std::vector<Eigen::LLT<StateMatrix>> factors(count);
  for (size_t k = 0; k < count; ++k) {
    Link& at = links_[k];
    factors[k].compute(at.diagonal);
    if (factors[k].info() != Eigen::Success) return solution;
    const BorderMatrix border = factors[k].solve(at.border);
    const StateVector right = factors[k].solve(at.right);
    common_.noalias() -= at.border.transpose() * border;
    common_right_.noalias() -= at.border.transpose() * right;
    if (k + 1 == count) break;
    Link& next = links_[k + 1];
    const StateMatrix step = factors[k].solve(at.next);
    next.diagonal.noalias() -= at.next.transpose() * step;
    next.border.noalias() -= at.next.transpose() * border;
    next.right.noalias() -= at.next.transpose() * right;
  }
  const Eigen::LLT<CommonMatrix> common(common_);
  if (common.info() != Eigen::Success) return solution;
  solution.common = common.solve(common_right_);
  const CommonMatrix common_covariance = common.solve(CommonMatrix::Identity());
  const BorderMatrix by_common = factors.back().solve(links_.back().border);
  solution.last_covariance << factors.back().solve(StateMatrix::Identity()) +
                                  by_common * common_covariance * by_common.transpose(),
      -by_common * common_covariance, -common_covariance * by_common.transpose(), common_covariance;

  // Backward.
  solution.states.resize(count);
  for (size_t k = count; k-- > 0;) {
    StateVector right = links_[k].right - links_[k].border * solution.common;
    if (k + 1 < count) right -= links_[k].next * solution.states[k + 1];
    solution.states[k] = factors[k].solve(right);
  }
  solution.ok = true;
  return solution;
}

}  // namespace alidade
