#include "alidade/optimize/pose_graph_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/base/parallel.h"

namespace alidade {
namespace {

constexpr int kChunk = 128;  // edges per task

int Chunks(size_t edges) { return static_cast<int>((edges + kChunk - 1) / kChunk); }

// Half of the Huber loss of a squared length, and the corresponding weight of the gradient.
double Loss(double squared, double huber, double* weight) {
  const double root = std::sqrt(squared);
  const bool within = huber <= 0 || root <= huber;
  if (weight) *weight = within ? 1 : huber / root;
  return within ? 0.5 * squared : huber * (root - 0.5 * huber);
}

}  // namespace

Vector7d EdgeResidual(const Sim3& T_a_b, const Sim3& T_a_world, const Sim3& T_b_world) {
  return LogSim3(T_a_b * (T_b_world * T_a_world.Inverse()));
}

PoseGraphResidual LineariseEdge(const Sim3& T_a_b, const Sim3& T_a_world, const Sim3& T_b_world) {
  PoseGraphResidual e;
  e.r = EdgeResidual(T_a_b, T_a_world, T_b_world);
  // Right Jacobian at r = left Jacobian at -r.
  const Matrix7d right = LeftJacobianInverseSim3(-e.r);
  e.J_a = -right;
  e.J_b = right * AdjointSim3(T_a_world * T_b_world.Inverse());
  return e;
}

template <int kDof>
PoseGraphSystem<kDof>::PoseGraphSystem(const PoseGraph& graph, std::vector<int> slot,
                                       std::vector<int> edges, double length_scale, double huber)
    : graph_(graph),
      slot_(std::move(slot)),
      edges_(std::move(edges)),
      unit_(Vector::Ones()),
      huber_(huber),
      terms_(edges_.size()) {
  unit_.template head<3>().setConstant(1 / length_scale);
  for (const int s : slot_) free_nodes_ = std::max(free_nodes_, s + 1);
  diagonal_.resize(free_nodes_);
  gradient_.resize(free_nodes_);
  FindBlocks();
}

template <int kDof>
void PoseGraphSystem<kDof>::FindBlocks() {
  std::vector<std::pair<int, int>> blocks;  // column, row
  const auto block_of = [&](int edge) {
    const auto [low, high] =
        std::minmax({slot_[graph_.edges[edge].a], slot_[graph_.edges[edge].b]});
    return std::pair(low, high);
  };
  for (const int edge : edges_) {
    if (block_of(edge).first >= 0) blocks.push_back(block_of(edge));
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  for (const int edge : edges_) {
    const auto found = std::lower_bound(blocks.begin(), blocks.end(), block_of(edge));
    below_.push_back(block_of(edge).first < 0 ? -1 : static_cast<int>(found - blocks.begin()));
  }
  off_.resize(blocks.size());
  std::vector<BlockPlace> places;
  for (const auto& [column, row] : blocks) places.push_back({row, column});
  factor_.Analyse(free_nodes_, places);
}

template <int kDof>
double PoseGraphSystem<kDof>::Cost(const std::vector<Sim3>& nodes) const {
  std::vector<double> costs(Chunks(edges_.size()));
  ParallelFor(static_cast<int>(costs.size()), [&](int chunk) {
    const size_t end = std::min(edges_.size(), static_cast<size_t>(chunk + 1) * kChunk);
    for (size_t n = static_cast<size_t>(chunk) * kChunk; n < end; ++n) {
      const PoseGraphEdge& edge = graph_.edges[edges_[n]];
      const Vector r = EdgeResidual(edge.T_a_b, nodes[edge.a], nodes[edge.b]).template head<kDof>();
      costs[chunk] += Loss(edge.weight * r.cwiseProduct(unit_).squaredNorm(), huber_, nullptr);
    }
  });
  double cost = 0;
  for (const double c : costs) cost += c;
  return cost;
}

template <int kDof>
void PoseGraphSystem<kDof>::Linearise(const std::vector<Sim3>& nodes) {
  ParallelFor(Chunks(edges_.size()), [&](int chunk) {
    const size_t end = std::min(edges_.size(), static_cast<size_t>(chunk + 1) * kChunk);
    for (size_t n = static_cast<size_t>(chunk) * kChunk; n < end; ++n) {
      const PoseGraphEdge& edge = graph_.edges[edges_[n]];
      const PoseGraphResidual e = LineariseEdge(edge.T_a_b, nodes[edge.a], nodes[edge.b]);
      Term& term = terms_[n];
      term.r = e.r.template head<kDof>().cwiseProduct(unit_);
      double weight;
      Loss(edge.weight * term.r.squaredNorm(), huber_, &weight);
      const double root = std::sqrt(weight * edge.weight);
      const Vector scale = root * unit_;
      term.r *= root;
      term.J_a = scale.asDiagonal() * e.J_a.template topLeftCorner<kDof, kDof>();
      term.J_b = scale.asDiagonal() * e.J_b.template topLeftCorner<kDof, kDof>();
    }
  });
  for (Block& block : diagonal_) block.setZero();
  for (Block& block : off_) block.setZero();
  for (Vector& g : gradient_) g.setZero();
  for (size_t n = 0; n < edges_.size(); ++n) {
    const int a = slot_[graph_.edges[edges_[n]].a], b = slot_[graph_.edges[edges_[n]].b];
    const Term& term = terms_[n];
    if (a >= 0) {
      diagonal_[a].noalias() += term.J_a.transpose() * term.J_a;
      gradient_[a].noalias() += term.J_a.transpose() * term.r;
    }
    if (b >= 0) {
      diagonal_[b].noalias() += term.J_b.transpose() * term.J_b;
      gradient_[b].noalias() += term.J_b.transpose() * term.r;
    }
    if (a < 0 || b < 0) continue;
    if (a > b) {
      off_[below_[n]].noalias() += term.J_a.transpose() * term.J_b;
    } else {
      off_[below_[n]].noalias() += term.J_b.transpose() * term.J_a;
    }
  }
}

template <int kDof>
void PoseGraphSystem<kDof>::Fill(double lambda) {
  const auto packed = [](const Block& from) {
    SquareBlock<kDof> to{};
    for (int j = 0; j < kDof; ++j) {
      for (int i = 0; i < kDof; ++i) to.Set(i, j, from(i, j));
    }
    return to;
  };
  factor_.Clear();
  for (int i = 0; i < free_nodes_; ++i) {
    Block damped = diagonal_[i];
    damped.diagonal() *= 1 + lambda;
    factor_.SetDiagonal(i, packed(damped));
  }
  for (size_t i = 0; i < off_.size(); ++i) factor_.SetBelow(i, packed(off_[i]));
}

template <int kDof>
bool PoseGraphSystem<kDof>::Solve(double lambda, std::vector<Vector>& step) {
  Fill(lambda);
  if (!factor_.Factorise()) return false;
  Eigen::VectorXd x(kDof * free_nodes_);
  for (int i = 0; i < free_nodes_; ++i) x.segment<kDof>(kDof * i) = -gradient_[i];
  factor_.Solve(x);
  if (!x.allFinite()) return false;
  step.resize(free_nodes_);
  for (int i = 0; i < free_nodes_; ++i) step[i] = x.segment<kDof>(kDof * i);
  return true;
}

// ½ (λ δ' diag(H) δ - g' δ), which equals -g' δ - ½ δ' H δ because (H + D) δ = -g.
template <int kDof>
double PoseGraphSystem<kDof>::Predicted(double lambda, const std::vector<Vector>& step) const {
  double twice = 0;
  for (int i = 0; i < free_nodes_; ++i) {
    twice += lambda * step[i].cwiseAbs2().dot(diagonal_[i].diagonal()) - step[i].dot(gradient_[i]);
  }
  return 0.5 * twice;
}

template class PoseGraphSystem<6>;
template class PoseGraphSystem<7>;

}  // namespace alidade
