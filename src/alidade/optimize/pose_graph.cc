#include "alidade/optimize/pose_graph.h"

#include <cmath>
#include <string>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/median.h"
#include "alidade/optimize/damping.h"
#include "alidade/optimize/pose_graph_system.h"

namespace alidade {
namespace {

// With larger damping a step is below the rounding error of the variables.
constexpr double kMaxLambda = 1e16;
constexpr double kMinLambda = 1e-15;

void CheckGraph(const PoseGraph& graph) {
  const int nodes = static_cast<int>(graph.T_camera_world.size());
  if (graph.fixed.size() != graph.T_camera_world.size()) {
    ThrowUsage("pose graph: " + std::to_string(nodes) + " nodes but " +
               std::to_string(graph.fixed.size()) + " flags of fixed ones");
  }
  const auto valid = [](const Sim3& T) {
    return T.R.allFinite() && T.t.allFinite() && std::isfinite(T.s) && T.s > 0;
  };
  for (int i = 0; i < nodes; ++i) {
    if (!valid(graph.T_camera_world[i])) {
      ThrowUsage("pose graph: node " + std::to_string(i) + " is no similarity");
    }
  }
  for (size_t n = 0; n < graph.edges.size(); ++n) {
    const PoseGraphEdge& edge = graph.edges[n];
    const std::string name = "pose graph: edge " + std::to_string(n);
    if (edge.a < 0 || edge.b < 0 || edge.a >= nodes || edge.b >= nodes) {
      ThrowUsage(name + " joins nodes " + std::to_string(edge.a) + " and " +
                 std::to_string(edge.b) + " of " + std::to_string(nodes));
    }
    if (edge.a == edge.b) ThrowUsage(name + " joins a node to itself");
    if (!valid(edge.T_a_b)) ThrowUsage(name + " measures no similarity");
    if (!(edge.weight >= 0) || !std::isfinite(edge.weight)) {
      ThrowUsage(name + ": its weight must not be negative");
    }
  }
}

// 1 for nodes connected to a fixed node.
std::vector<uint8_t> Anchored(const PoseGraph& graph) {
  std::vector<std::vector<int>> neighbours(graph.T_camera_world.size());
  for (const PoseGraphEdge& edge : graph.edges) {
    if (edge.weight <= 0) continue;
    neighbours[edge.a].push_back(edge.b);
    neighbours[edge.b].push_back(edge.a);
  }
  std::vector<uint8_t> anchored(graph.T_camera_world.size(), 0);
  std::vector<int> open;
  for (size_t i = 0; i < anchored.size(); ++i) {
    if (graph.fixed[i]) open.push_back(static_cast<int>(i));
  }
  while (!open.empty()) {
    const int node = open.back();
    open.pop_back();
    if (anchored[node]) continue;
    anchored[node] = 1;
    open.insert(open.end(), neighbours[node].begin(), neighbours[node].end());
  }
  return anchored;
}

// 10 × the median edge length, ignoring zero lengths; 1 if there are none.
double LengthScale(const PoseGraph& graph, const std::vector<int>& edges) {
  std::vector<double> lengths;
  for (const int edge : edges) {
    const double length = graph.edges[edge].T_a_b.t.norm();
    if (length > 0) lengths.push_back(length);
  }
  if (lengths.empty()) return 1;
  return 10 * UpperMedian(lengths);
}

template <int kDof>
PoseGraphReport Minimise(PoseGraph& graph, const std::vector<int>& slot,
                         const std::vector<int>& edges, const PoseGraphSettings& settings,
                         const std::atomic<bool>* stop) {
  const double length_scale =
      settings.length_scale > 0 ? settings.length_scale : LengthScale(graph, edges);
  PoseGraphSystem<kDof> system(graph, slot, edges, length_scale, settings.huber);
  std::vector<Sim3> nodes = graph.T_camera_world, trial;
  std::vector<typename PoseGraphSystem<kDof>::Vector> step;
  double total_weight = 0;
  for (const int edge : edges) total_weight += graph.edges[edge].weight;

  PoseGraphReport report;
  double cost = system.Cost(nodes);
  report.initial_cost = report.final_cost = cost;
  // Residuals of 1e-13 are rounding errors: nothing left to optimize.
  const double nothing = 1e-26 * total_weight;
  report.converged = cost <= nothing;
  bool linearised = false;
  Damping damping{settings.initial_lambda, kMinLambda};
  while (!report.converged && report.iterations < settings.max_iterations) {
    if (stop && *stop) break;
    ++report.iterations;
    if (!linearised) system.Linearise(nodes);
    linearised = true;
    if (!system.Solve(damping.lambda, step)) {
      damping.Rejected();
      report.converged = damping.lambda >= kMaxLambda;
      continue;
    }
    trial = nodes;
    for (size_t i = 0; i < nodes.size(); ++i) {
      if (slot[i] < 0) continue;
      Vector7d xi = Vector7d::Zero();
      xi.head<kDof>() = step[slot[i]];
      trial[i] = ExpSim3(xi) * nodes[i];
    }
    const double predicted = system.Predicted(damping.lambda, step);
    const double next = system.Cost(trial), actual = cost - next;
    const bool better = actual > 0;  // also false for NaN
    report.converged = predicted <= 1e-14 * cost || next <= nothing ||
                       (better && actual < settings.min_relative_decrease * cost);
    if (better) {
      std::swap(nodes, trial);
      cost = next;
      damping.Accepted(actual, predicted);
      linearised = false;
    } else {
      damping.Rejected();
      report.converged |= damping.lambda >= kMaxLambda;
    }
  }
  report.final_cost = cost;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (slot[i] < 0) continue;
    graph.T_camera_world[i] = nodes[i];
    graph.T_camera_world[i].R = Eigen::Quaterniond(nodes[i].R).normalized().toRotationMatrix();
  }
  return report;
}

}  // namespace

void PoseGraphSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("pose graph settings: ") + what);
  };
  require(max_iterations >= 0, "max_iterations must not be negative");
  require(min_relative_decrease >= 0 && min_relative_decrease < 1,
          "min_relative_decrease must be at least 0 and below 1");
  require(huber >= 0 && std::isfinite(huber), "huber must not be negative");
  require(initial_lambda > 0 && std::isfinite(initial_lambda), "initial_lambda must be above 0");
  require(length_scale >= 0 && std::isfinite(length_scale), "length_scale must not be negative");
}

PoseGraphReport OptimizePoseGraph(PoseGraph& graph, const PoseGraphSettings& settings,
                                  const std::atomic<bool>* stop) {
  settings.Check();
  CheckGraph(graph);
  if (!graph.with_scale) {
    for (Sim3& T : graph.T_camera_world) T.s = 1;
    for (PoseGraphEdge& edge : graph.edges) edge.T_a_b.s = 1;
  }
  const std::vector<uint8_t> anchored = Anchored(graph);
  std::vector<int> slot(anchored.size(), -1), edges;
  int free_nodes = 0;
  for (size_t i = 0; i < slot.size(); ++i) {
    if (anchored[i] && !graph.fixed[i]) slot[i] = free_nodes++;
  }
  for (size_t n = 0; n < graph.edges.size(); ++n) {
    const PoseGraphEdge& edge = graph.edges[n];
    const bool counts = edge.weight > 0 && (slot[edge.a] >= 0 || slot[edge.b] >= 0);
    if (counts) edges.push_back(static_cast<int>(n));
  }
  if (edges.empty()) {
    PoseGraphReport report;
    report.converged = true;
    return report;
  }
  return graph.with_scale ? Minimise<7>(graph, slot, edges, settings, stop)
                          : Minimise<6>(graph, slot, edges, settings, stop);
}

}  // namespace alidade
