// Normal equations of a pose graph and their solution. The structure (free nodes, nonzero blocks,
// elimination order) is computed once.
#pragma once

#include <vector>

#include "alidade/geometry/sim3.h"
#include "alidade/optimize/block_cholesky.h"
#include "alidade/optimize/pose_graph.h"

namespace alidade {

// Residual of an edge and its Jacobians with respect to left increments of its two nodes (Solà et
// al. 2018, §IV-B, in Sim(3)). With E = T_a_b T_b_world T_world_a, the increment of Log E is
//   Jr⁻¹(Log E) (Ad(T_a_world T_world_b) δ_b - δ_a).
struct PoseGraphResidual {
  Vector7d r;
  Matrix7d J_a, J_b;
};
Vector7d EdgeResidual(const Sim3& T_a_b, const Sim3& T_a_world, const Sim3& T_b_world);
PoseGraphResidual LineariseEdge(const Sim3& T_a_b, const Sim3& T_a_world, const Sim3& T_b_world);

// kDof: 7 with scale, 6 without.
template <int kDof>
class PoseGraphSystem {
 public:
  using Block = Eigen::Matrix<double, kDof, kDof>;
  using Vector = Eigen::Matrix<double, kDof, 1>;

  // `slot`: index among the free nodes, -1: fixed. `edges`: indices of the edges to use.
  PoseGraphSystem(const PoseGraph& graph, std::vector<int> slot, std::vector<int> edges,
                  double length_scale, double huber);

  int free_nodes() const { return free_nodes_; }
  double Cost(const std::vector<Sim3>& nodes) const;
  void Linearise(const std::vector<Sim3>& nodes);
  // Solves (H + λ diag H) δ = -g, by slot. Returns false if H could not be factored.
  bool Solve(double lambda, std::vector<Vector>& step);
  // Decrease of the cost by the last step in the quadratic model.
  double Predicted(double lambda, const std::vector<Vector>& step) const;

 private:
  struct Term {  // of one edge: Jacobians by a and b, and residual, each × sqrt(weight)
    Block J_a, J_b;
    Vector r;
  };
  void FindBlocks();
  void Fill(double lambda);

  const PoseGraph& graph_;
  std::vector<int> slot_, edges_;
  int free_nodes_ = 0;
  Vector unit_;  // scale factors of the residual's components
  double huber_;
  std::vector<int> below_;  // for each edge, the index of its block below the diagonal, or -1
  std::vector<Term> terms_;
  std::vector<Block> diagonal_, off_;
  std::vector<Vector> gradient_;
  BlockCholesky<kDof> factor_;
};

}  // namespace alidade
