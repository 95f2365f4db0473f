// Normal equations of a pose graph, and their solution: what does not change from step to step (who
// is free, which blocks are not zero, the order of elimination) is found once.
#pragma once

#include <vector>

#include "alidade/geometry/sim3.h"
#include "alidade/optimize/block_cholesky.h"
#include "alidade/optimize/pose_graph.h"

namespace alidade {

// Residual of an edge, and its derivatives by left increments of its two nodes (Solà et al. 2018,
// §IV-B, in Sim(3)): with E = T_a_b T_b_world T_world_a, Log moves by
//   Jr⁻¹(Log E) (Ad(T_a_world T_world_b) δ_b - δ_a).
struct PoseGraphResidual {
  Vector7d r;
  Matrix7d J_a, J_b;
};
Vector7d EdgeResidual(const Sim3& T_a_b, const Sim3& T_a_world, const Sim3& T_b_world);
PoseGraphResidual LineariseEdge(const Sim3& T_a_b, const Sim3& T_a_world, const Sim3& T_b_world);

// Kind: 7 with scale, 6 without.
template <int kDof>
class PoseGraphSystem {
 public:
  using Block = Eigen::Matrix<double, kDof, kDof>;
  using Vector = Eigen::Matrix<double, kDof, 1>;

  // `slot`: index among the free nodes, -1: held. Only `edges` (indices) count.
  PoseGraphSystem(const PoseGraph& graph, std::vector<int> slot, std::vector<int> edges,
                  double length_scale, double huber);

  int free_nodes() const { return free_nodes_; }
  double Cost(const std::vector<Sim3>& nodes) const;
  void Linearise(const std::vector<Sim3>& nodes);
  // Of (H + λ diag H) δ = -g, by slot. False: it could not be factored.
  bool Solve(double lambda, std::vector<Vector>& step);
  // Decrease of the cost by the last step, were it quadratic.
  double Predicted(double lambda, const std::vector<Vector>& step) const;

 private:
  struct Term {  // of an edge: derivatives by a and by b, and the residual, each × sqrt(weight)
    Block J_a, J_b;
    Vector r;
  };
  void FindBlocks();
  void Fill(double lambda);

  const PoseGraph& graph_;
  std::vector<int> slot_, edges_;
  int free_nodes_ = 0;
  Vector unit_;  // what a residual is multiplied with
  double huber_;
  std::vector<int> below_;  // for each edge its block below the diagonal, or -1
  std::vector<Term> terms_;
  std::vector<Block> diagonal_, off_;
  std::vector<Vector> gradient_;
  BlockCholesky<kDof> factor_;
};

}  // namespace alidade
