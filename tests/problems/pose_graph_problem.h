// A closed path of cameras whose relative poses were measured with drift, and the tie that closes
// it: for tests and benchmarks.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "alidade/geometry/sim3.h"
#include "alidade/optimize/pose_graph.h"
#include "problems/pose_problem.h"

namespace alidade {

struct PoseGraphProblemOptions {
  int nodes = 100;
  int neighbours = 3;         // each node is tied to as many before it
  double step = 0.3;          // between nodes, map units
  double translation = 0.01;  // standard deviation of an edge, share of its length
  double rotation = 0.002;    // radians
  double log_scale = 0.002;   // 0: rigid
  double bias = 0.0005;       // the same turn in every edge (radians), and growth of log scale
  bool with_scale = true;
  double unit = 1;  // of the map: all lengths are multiplied with it
  uint64_t seed = 1;
};

struct PoseGraphProblem {
  PoseGraph graph;
  std::vector<Sim3> truth;  // T_camera_world
};

// Around a circle that rises and falls, looking outwards.
inline Se3 LoopCameraAt(double radius, double share) {
  const double angle = 2 * std::numbers::pi * share;
  const Eigen::Vector3d turn(0.1 * std::sin(3 * angle), 0, 0);
  const Eigen::Matrix3d R = ExpSo3(turn) * ExpSo3(Eigen::Vector3d(0, angle, 0));
  const Eigen::Vector3d centre(radius * std::sin(angle), 0.05 * radius * std::sin(2 * angle),
                               -radius * std::cos(angle));
  return {R, -(R * centre)};
}

inline PoseGraphProblem MakePoseGraphProblem(const PoseGraphProblemOptions& options) {
  PoseGraphProblem problem;
  PoseGraph& graph = problem.graph;
  graph.with_scale = options.with_scale;
  Random random(options.seed);
  const double radius = options.step * options.nodes / (2 * std::numbers::pi);
  for (int i = 0; i < options.nodes; ++i) {
    const Se3 T = LoopCameraAt(radius, static_cast<double>(i) / options.nodes);
    problem.truth.push_back({1, T.R, options.unit * T.t});
    graph.fixed.push_back(i == 0);
  }
  const auto relative = [&](int a, int b) { return problem.truth[a] * problem.truth[b].Inverse(); };
  for (int b = 1; b < options.nodes; ++b) {
    for (int a = b - 1; a >= std::max(0, b - options.neighbours); --a) {
      const Sim3 exact = relative(a, b);
      Vector7d error;
      error.head<3>() = RandomVector(random, options.translation * exact.t.norm());
      error.segment<3>(3) = RandomVector(random, options.rotation);
      error[4] += options.bias * (b - a);
      error[6] =
          options.with_scale ? options.log_scale * random.Gaussian() + options.bias * (b - a) : 0;
      graph.edges.push_back({a, b, ExpSim3(error) * exact, 1});
    }
  }
  // As the tracker left it: one step after the other.
  graph.T_camera_world.push_back(problem.truth[0]);
  for (const PoseGraphEdge& edge : graph.edges) {
    if (edge.a != edge.b - 1) continue;
    graph.T_camera_world.push_back(edge.T_a_b.Inverse() * graph.T_camera_world[edge.a]);
  }
  for (int i = 0; i < options.neighbours; ++i) {  // the loop is recognised
    graph.edges.push_back({options.nodes - 1 - i, i, relative(options.nodes - 1 - i, i), 1});
  }
  return problem;
}

// Root mean square distance of the cameras' centres from the truth.
inline double CentreError(const std::vector<Sim3>& nodes, const std::vector<Sim3>& truth) {
  double sum = 0;
  for (size_t i = 0; i < nodes.size(); ++i) {
    sum += (nodes[i].Inverse().t - truth[i].Inverse().t).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(nodes.size()));
}

}  // namespace alidade
