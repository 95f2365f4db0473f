#include "alidade/optimize/pose_graph.h"

#include <gtest/gtest.h>

#include <limits>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/optimize/pose_graph_system.h"
#include "ceres_sim3.h"
#include "problems/pose_graph_problem.h"
#include "support/expect_error.h"

namespace alidade::pose_graph_test {
namespace {

constexpr PoseGraphSettings kToTheEnd{
    .max_iterations = 200, .min_relative_decrease = 1e-14, .length_scale = 2};

struct CeresEdge {
  Sim3 T_a_b;
  double weight, length_scale;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    const Eigen::Matrix<T, 7, 1> xi =
        (CeresSim3<T>::Of(T_a_b) * CeresSim3<T>::Of(b) * CeresSim3<T>::Of(a).Inverse()).Log();
    for (int i = 0; i < 7; ++i) {
      residual[i] = std::sqrt(weight) * xi[i] / (i < 3 ? length_scale : 1.0);
    }
    return true;
  }
};

ceres::Solver::Summary OptimizeWithCeres(PoseGraph& graph, const PoseGraphSettings& settings,
                                         int max_iterations = 300) {
  std::vector<Vector7d> nodes;
  for (const Sim3& T : graph.T_camera_world) nodes.push_back(ToCeresSim3(T));
  ceres::Problem problem;
  for (const PoseGraphEdge& edge : graph.edges) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CeresEdge, 7, 7, 7>(
                                 new CeresEdge{edge.T_a_b, edge.weight, settings.length_scale}),
                             settings.huber > 0 ? new ceres::HuberLoss(settings.huber) : nullptr,
                             nodes[edge.a].data(), nodes[edge.b].data());
  }
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (!problem.HasParameterBlock(nodes[i].data())) continue;
    if (graph.fixed[i]) {
      problem.SetParameterBlockConstant(nodes[i].data());
    } else if (!graph.with_scale) {
      problem.SetManifold(nodes[i].data(), new ceres::SubsetManifold(7, {6}));
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-15;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-15;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (size_t i = 0; i < nodes.size(); ++i) graph.T_camera_world[i] = FromCeresSim3(nodes[i]);
  return summary;
}

TEST(PoseGraphEdge, JacobiansAreThoseOfAutomaticDerivatives) {
  Random random(1);
  for (const double spread : {0.0, 1e-9, 1e-3, 0.3}) {
    const auto draw = [&](double size) {
      Vector7d xi;
      xi << RandomIncrement(random, 2 * size, size), 0.5 * size * random.Gaussian();
      return ExpSim3(xi);
    };
    const Sim3 a = draw(0.8), b = draw(0.8);
    const Sim3 measured = draw(spread) * a * b.Inverse();
    const PoseGraphResidual ours = LineariseEdge(measured, a, b);
    using Jet = ceres::Jet<double, 14>;
    Jet x[14];
    for (int node = 0; node < 2; ++node) {  // Exp(xi) at xi = 0, exact to first order
      for (int d = 0; d < 3; ++d) {
        x[7 * node + d] = Jet(0, 7 * node + 3 + d);
        x[7 * node + 3 + d] = Jet(0, 7 * node + d);
      }
      x[7 * node + 6] = Jet(0, 7 * node + 6);
    }
    const CeresSim3<Jet> S_a = CeresSim3<Jet>::Of(x) * CeresSim3<Jet>::Of(a),
                         S_b = CeresSim3<Jet>::Of(x + 7) * CeresSim3<Jet>::Of(b);
    const Eigen::Matrix<Jet, 7, 1> r = (CeresSim3<Jet>::Of(measured) * S_b * S_a.Inverse()).Log();
    for (int i = 0; i < 7; ++i) {
      EXPECT_NEAR(ours.r[i], r[i].a, 1e-12) << spread;
      for (int j = 0; j < 7; ++j) {
        EXPECT_NEAR(ours.J_a(i, j), r[i].v[j], 1e-9) << spread;
        EXPECT_NEAR(ours.J_b(i, j), r[i].v[7 + j], 1e-9) << spread;
      }
    }
  }
}

void ExpectSameOptimum(const PoseGraphProblem& problem, const PoseGraphSettings& settings) {
  PoseGraph ours = problem.graph, theirs = problem.graph;
  const PoseGraphReport report = OptimizePoseGraph(ours, settings);
  const ceres::Solver::Summary summary = OptimizeWithCeres(theirs, settings);
  EXPECT_NEAR(report.initial_cost, summary.initial_cost, 1e-9 * summary.initial_cost);
  EXPECT_NEAR(report.final_cost, summary.final_cost, 1e-6 * summary.final_cost)
      << summary.BriefReport() << " ours " << report.iterations;
  EXPECT_LT(report.final_cost, 0.7 * report.initial_cost);
  EXPECT_TRUE(report.converged);
  // Check that the returned state has the reported cost, as computed by Ceres.
  PoseGraph copy = ours;
  EXPECT_NEAR(OptimizeWithCeres(copy, settings, 0).initial_cost, report.final_cost,
              1e-9 * report.final_cost);
  // Both find the same optimum.
  EXPECT_LT(CentreError(ours.T_camera_world, theirs.T_camera_world),
            1e-3 * CentreError(problem.graph.T_camera_world, problem.truth));
}

TEST(OptimizePoseGraph, AgreesWithCeresOnALoopWhoseScaleDrifted) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    ExpectSameOptimum(MakePoseGraphProblem({.nodes = 80, .seed = seed}), kToTheEnd);
  }
}

TEST(OptimizePoseGraph, AgreesWithCeresWithoutScale) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const PoseGraphProblem problem =
        MakePoseGraphProblem({.nodes = 80, .with_scale = false, .seed = seed});
    ExpectSameOptimum(problem, kToTheEnd);
    PoseGraph graph = problem.graph;
    OptimizePoseGraph(graph);
    for (const Sim3& T : graph.T_camera_world) EXPECT_EQ(T.s, 1);
  }
}

TEST(OptimizePoseGraph, AgreesWithCeresWithALossAndUnequalWeights) {
  PoseGraphProblem problem = MakePoseGraphProblem({.nodes = 60, .seed = 4});
  Random random(4, 1);
  for (PoseGraphEdge& edge : problem.graph.edges) edge.weight = random.Uniform(0.2, 5);
  PoseGraphSettings settings = kToTheEnd;
  settings.huber = 0.004;
  ExpectSameOptimum(problem, settings);
}

TEST(OptimizePoseGraph, ClosesALoopOfExactStepsExactly) {
  for (const bool with_scale : {true, false}) {
    // Measurements without error, initial poses with drift.
    PoseGraphProblem problem = MakePoseGraphProblem({.nodes = 200, .with_scale = with_scale});
    PoseGraph& graph = problem.graph;
    for (PoseGraphEdge& edge : graph.edges) {
      edge.T_a_b = problem.truth[edge.a] * problem.truth[edge.b].Inverse();
    }
    EXPECT_GT(CentreError(graph.T_camera_world, problem.truth), 0.5);
    const PoseGraphReport report = OptimizePoseGraph(graph);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.iterations, 20);
    EXPECT_LT(CentreError(graph.T_camera_world, problem.truth), 1e-6);
  }
}

TEST(OptimizePoseGraph, DriftOfScaleIsSpreadOverTheLoop) {
  PoseGraphProblem problem = MakePoseGraphProblem({.nodes = 150, .seed = 6});
  PoseGraph& graph = problem.graph;
  const double before = CentreError(graph.T_camera_world, problem.truth);
  EXPECT_GT(std::abs(std::log(graph.T_camera_world.back().s)), 0.05);
  OptimizePoseGraph(graph);
  EXPECT_LT(CentreError(graph.T_camera_world, problem.truth), 0.2 * before);
  for (const Sim3& T : graph.T_camera_world) EXPECT_LT(std::abs(std::log(T.s)), 0.03);
}

TEST(OptimizePoseGraph, TheMapsUnitMakesNoDifference) {
  PoseGraphProblem metres = MakePoseGraphProblem({.seed = 7});
  for (const double unit : {1e-3, 7.0, 1e4}) {
    PoseGraph one = metres.graph;
    PoseGraph other = MakePoseGraphProblem({.unit = unit, .seed = 7}).graph;
    const PoseGraphReport expected = OptimizePoseGraph(one);
    const PoseGraphReport report = OptimizePoseGraph(other);
    EXPECT_EQ(report.iterations, expected.iterations);
    EXPECT_NEAR(report.final_cost, expected.final_cost, 1e-9 * expected.final_cost);
    for (size_t i = 0; i < one.T_camera_world.size(); ++i) {
      const Sim3 &a = one.T_camera_world[i], &b = other.T_camera_world[i];
      EXPECT_LT((a.t - b.t / unit).norm(), 1e-8);
      EXPECT_NEAR(a.s, b.s, 1e-8);
    }
  }
}

TEST(OptimizePoseGraph, NodesWithoutATieToAFixedOneStayWhereTheyAre) {
  PoseGraphProblem problem = MakePoseGraphProblem({.nodes = 40, .seed = 8});
  PoseGraph& graph = problem.graph;
  PoseGraph alone = graph;
  // Two nodes connected to each other only, an isolated node, and one with a zero-weight edge.
  Random random(9);
  for (int i = 0; i < 4; ++i) {
    graph.T_camera_world.push_back(
        ExpSim3((Vector7d() << RandomIncrement(random, 1, 1), 0.1).finished()));
    graph.fixed.push_back(0);
  }
  graph.edges.push_back({40, 41, Sim3{}, 1});
  graph.edges.push_back({43, 3, Sim3{}, 0});
  const PoseGraph before = graph;
  const PoseGraphReport report = OptimizePoseGraph(graph);
  for (int i = 40; i < 44; ++i) {
    EXPECT_EQ(graph.T_camera_world[i].t, before.T_camera_world[i].t) << i;
    EXPECT_EQ(graph.T_camera_world[i].R, before.T_camera_world[i].R) << i;
    EXPECT_EQ(graph.T_camera_world[i].s, before.T_camera_world[i].s) << i;
  }
  // They do not affect the other nodes.
  EXPECT_EQ(report.final_cost, OptimizePoseGraph(alone).final_cost);
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(graph.T_camera_world[i].t, alone.T_camera_world[i].t) << i;
  }
  EXPECT_EQ(graph.T_camera_world[0].t, before.T_camera_world[0].t);  // fixed

  for (uint8_t& fixed : graph.fixed) fixed = 0;
  const PoseGraph floating = graph;
  EXPECT_TRUE(OptimizePoseGraph(graph).converged);
  for (int i = 0; i < 44; ++i) {
    EXPECT_EQ(graph.T_camera_world[i].t, floating.T_camera_world[i].t) << i;
  }
}

TEST(OptimizePoseGraph, SameResultWithAnyNumberOfThreads) {
  const PoseGraphProblem problem = MakePoseGraphProblem({.nodes = 300, .seed = 10});
  std::vector<PoseGraph> results;
  for (const int threads : {1, 2, 5}) {
    SetThreadCount(threads);
    results.push_back(problem.graph);
    OptimizePoseGraph(results.back());
  }
  SetThreadCount(0);
  for (const PoseGraph& result : results) {
    for (size_t i = 0; i < result.T_camera_world.size(); ++i) {
      EXPECT_EQ(result.T_camera_world[i].t, results[0].T_camera_world[i].t);
      EXPECT_EQ(result.T_camera_world[i].R, results[0].T_camera_world[i].R);
      EXPECT_EQ(result.T_camera_world[i].s, results[0].T_camera_world[i].s);
    }
  }
}

TEST(OptimizePoseGraph, StopsWhenAskedTo) {
  PoseGraphProblem problem = MakePoseGraphProblem({.nodes = 30, .seed = 11});
  const PoseGraph before = problem.graph;
  const std::atomic<bool> stop = true;
  const PoseGraphReport report = OptimizePoseGraph(problem.graph, {}, &stop);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.initial_cost, report.final_cost);
  EXPECT_EQ(problem.graph.T_camera_world[7].t, before.T_camera_world[7].t);
}

TEST(OptimizePoseGraph, WhatCannotBeIsAnError) {
  const PoseGraph good = MakePoseGraphProblem({.nodes = 10}).graph;
  const auto complaint = [&](auto spoil) -> std::string {
    PoseGraph graph = good;
    spoil(graph);
    try {
      OptimizePoseGraph(graph);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(complaint([](PoseGraph&) {}), "");
  EXPECT_EQ(complaint([](PoseGraph& g) { g = {}; }), "");
  EXPECT_NE(complaint([](PoseGraph& g) { g.edges[3].b = 10; }).find("edge 3"), std::string::npos);
  EXPECT_NE(complaint([](PoseGraph& g) { g.edges[2].a = -1; }).find("edge 2"), std::string::npos);
  EXPECT_NE(complaint([](PoseGraph& g) { g.edges[1].a = g.edges[1].b; }).find("itself"),
            std::string::npos);
  EXPECT_NE(complaint([](PoseGraph& g) { g.edges[1].weight = -1; }).find("weight"),
            std::string::npos);
  EXPECT_NE(complaint([&](PoseGraph& g) { g.edges[1].T_a_b.t.x() = nan; }).find("edge 1"),
            std::string::npos);
  EXPECT_NE(complaint([](PoseGraph& g) { g.T_camera_world[4].s = 0; }).find("node 4"),
            std::string::npos);
  EXPECT_NE(complaint([](PoseGraph& g) { g.fixed.pop_back(); }).find("fixed"), std::string::npos);
}

TEST(OptimizePoseGraph, SettingsThatCannotBeAreNamed) {
  const auto complaint = ComplaintAbout<PoseGraphSettings>;
  EXPECT_EQ(complaint({}), "");
  EXPECT_NE(complaint({.max_iterations = -1}).find("max_iterations"), std::string::npos);
  EXPECT_NE(complaint({.min_relative_decrease = 1}).find("min_relative"), std::string::npos);
  EXPECT_NE(complaint({.huber = -1}).find("huber"), std::string::npos);
  EXPECT_NE(complaint({.initial_lambda = 0}).find("initial_lambda"), std::string::npos);
  EXPECT_NE(complaint({.length_scale = -2}).find("length_scale"), std::string::npos);
}

}  // namespace
}  // namespace alidade::pose_graph_test
