#include "alidade/optimize/sim3_refine.h"

#include <gtest/gtest.h>

#include <limits>

#include "alidade/base/error.h"
#include "ceres_sim3.h"
#include "problems/sim3_problem.h"
#include "support/expect_error.h"

namespace alidade::sim3_refine_test {
namespace {

// Both residuals of one match, as a function of (rotation, translation, log scale).
struct CeresSim3Residual {
  Camera camera;
  Sim3Match m;

  template <typename T>
  void Project(const Eigen::Matrix<T, 3, 1>& p, const Eigen::Vector2d& pixel, double sigma,
               T* residual) const {
    residual[0] = (camera.fx * p.x() / p.z() + camera.cx - pixel.x()) / sigma;
    residual[1] = (camera.fy * p.y() / p.z() + camera.cy - pixel.y()) / sigma;
  }
  template <typename T>
  bool operator()(const T* x, T* residual) const {
    const CeresSim3<T> S = CeresSim3<T>::Of(x);
    Project<T>(S * m.p_b.cast<T>(), m.pixel_a, m.sigma_a, residual);
    Project<T>(S.Inverse() * m.p_a.cast<T>(), m.pixel_b, m.sigma_b, residual + 2);
    return true;
  }
};

std::pair<Sim3, double> SolveWithCeres(const Sim3Problem& problem, const Sim3& start,
                                       const std::vector<bool>& used, bool with_scale) {
  Vector7d x = ToCeresSim3(start);
  ceres::Problem ceres_problem;
  for (size_t i = 0; i < problem.matches.size(); ++i) {
    if (!used[i]) continue;
    ceres_problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CeresSim3Residual, 4, 7>(
                                       new CeresSim3Residual{problem.camera, problem.matches[i]}),
                                   nullptr, x.data());
  }
  if (!with_scale) {
    ceres_problem.SetManifold(x.data(), new ceres::SubsetManifold(7, {6}));
  }
  ceres::Solver::Options options;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  return {FromCeresSim3(x), summary.final_cost};
}

Sim3 Away(const Sim3& truth, bool with_scale, uint64_t seed) {
  Random random(seed, 1);
  Vector7d xi;
  xi << RandomIncrement(random, 0.05, 0.03), with_scale ? 0.05 * random.Gaussian() : 0;
  return ExpSim3(xi) * truth;
}

TEST(RefineSim3, ReturnsToTruthAmongWrongMatches) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const bool with_scale = seed % 2;
    const Sim3Problem problem = MakeSim3Problem(
        {.matches = 150, .outliers = 0.3, .scale = with_scale ? 1.3 : 1, .seed = seed});
    const Sim3RefineResult result = RefineSim3(
        problem.camera, Away(problem.truth, with_scale, seed), problem.matches, with_scale);
    // 100 points with 1 % depth error, pixel noise 1 to 3.6.
    EXPECT_NEAR(result.T_a_b.s / problem.truth.s, 1, with_scale ? 0.01 : 0) << seed;
    EXPECT_LT(LogSo3(result.T_a_b.R.transpose() * problem.truth.R).norm(), 0.005) << seed;
    EXPECT_LT((result.T_a_b.t - problem.truth.t).norm(), 0.04) << seed;
    int wrong = 0, lost = 0;
    for (size_t i = 0; i < problem.matches.size(); ++i) {
      wrong += result.inlier[i] && problem.outlier[i];
      lost += !result.inlier[i] && !problem.outlier[i];
    }
    EXPECT_LE(wrong, 2) << seed;
    EXPECT_LE(lost, 25) << seed;  // of 105: point errors add to the pixel errors
    EXPECT_EQ(result.inliers, std::count(result.inlier.begin(), result.inlier.end(), true));
  }
}

TEST(RefineSim3, AgreesWithCeresOnTheInliersItFound) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const bool with_scale = seed % 2;
    const Sim3Problem problem = MakeSim3Problem(
        {.matches = 100, .outliers = 0.2, .scale = with_scale ? 0.7 : 1, .seed = seed});
    const Sim3 start = Away(problem.truth, with_scale, seed);
    const Sim3RefineResult ours = RefineSim3(problem.camera, start, problem.matches, with_scale);
    const auto [T, cost] = SolveWithCeres(problem, start, ours.inlier, with_scale);
    EXPECT_NEAR(ours.cost, cost, 1e-6 * cost) << seed;
    EXPECT_LT(LogSim3(ours.T_a_b * T.Inverse()).norm(), 1e-4) << seed;
  }
}

TEST(RefineSim3, InformationIsThatOfAutomaticDerivatives) {
  for (const bool with_scale : {true, false}) {
    const Sim3Problem problem =
        MakeSim3Problem({.matches = 60, .scale = with_scale ? 1.3 : 1, .seed = 3});
    const Sim3RefineResult result =
        RefineSim3(problem.camera, problem.truth, problem.matches, with_scale);
    Matrix7d expected = Matrix7d::Zero();
    using Jet = ceres::Jet<double, 7>;
    for (size_t i = 0; i < problem.matches.size(); ++i) {
      if (!result.inlier[i]) continue;
      const Sim3Match& m = problem.matches[i];
      // Exp(xi) at xi = 0, exact to first order.
      Jet x[7], residual[4];
      for (int d = 0; d < 3; ++d) {
        x[d] = Jet(0, 3 + d);
        x[3 + d] = Jet(0, d);
      }
      x[6] = with_scale ? Jet(0, 6) : Jet(0);
      const CeresSim3<Jet> S = CeresSim3<Jet>::Of(x) * CeresSim3<Jet>::Of(result.T_a_b);
      const CeresSim3Residual error{problem.camera, m};
      error.Project<Jet>(S * m.p_b.cast<Jet>(), m.pixel_a, m.sigma_a, residual);
      error.Project<Jet>(S.Inverse() * m.p_a.cast<Jet>(), m.pixel_b, m.sigma_b, residual + 2);
      for (const Jet& r : residual) expected += r.v * r.v.transpose();
    }
    EXPECT_LT((result.information - expected).norm(), 1e-9 * expected.norm());
  }
}

TEST(RefineSim3, FewerThanThreeMatchesGiveBackTheStart) {
  const Sim3Problem problem = MakeSim3Problem({.matches = 2, .seed = 7});
  const Sim3RefineResult result = RefineSim3(problem.camera, problem.truth, problem.matches, true);
  EXPECT_EQ(result.T_a_b.R, problem.truth.R);
  EXPECT_EQ(result.T_a_b.t, problem.truth.t);
  EXPECT_EQ(result.T_a_b.s, problem.truth.s);
  EXPECT_EQ(result.inliers, 0);
  EXPECT_EQ(result.inlier, std::vector<bool>(2, false));
  EXPECT_EQ(RefineSim3(problem.camera, problem.truth, {}, true).inliers, 0);
}

TEST(RefineSim3, LooksPastMatchesThatAreNotNumbersOrBehindTheCamera) {
  Sim3Problem problem =
      MakeSim3Problem({.matches = 80, .noise_px = 0, .depth_noise = 0, .seed = 5});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  problem.matches[0].p_a.x() = nan;
  problem.matches[1].p_b.z() = inf;
  problem.matches[2].pixel_a.x() = nan;
  problem.matches[3].pixel_b.y() = -inf;
  problem.matches[4].sigma_a = nan;
  problem.matches[5].sigma_b = 0;
  problem.matches[6].sigma_b = inf;
  for (int i = 7; i < 10; ++i) problem.matches[i].p_b = -problem.matches[i].p_b;
  const Sim3RefineResult result =
      RefineSim3(problem.camera, Away(problem.truth, true, 5), problem.matches, true);
  EXPECT_EQ(result.inliers, 70);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(result.inlier[i]) << i;
  EXPECT_LT(LogSim3(result.T_a_b * problem.truth.Inverse()).norm(), 1e-7);
}

TEST(RefineSim3, DegenerateMatchesGiveAFiniteAnswer) {
  Sim3Problem problem = MakeSim3Problem({.matches = 30, .seed = 8});
  for (Sim3Match& m : problem.matches) m = problem.matches[0];
  const Sim3RefineResult result = RefineSim3(problem.camera, problem.truth, problem.matches, true);
  EXPECT_TRUE(result.T_a_b.R.allFinite());
  EXPECT_TRUE(result.T_a_b.t.allFinite());
  EXPECT_GT(result.T_a_b.s, 0);
  EXPECT_TRUE(std::isfinite(result.T_a_b.s));
}

TEST(RefineSim3, SettingsThatCannotBeAreNamed) {
  const auto complaint = ComplaintAbout<Sim3RefineSettings>;
  EXPECT_EQ(complaint({}), "");
  EXPECT_NE(complaint({.max_iterations = 0}).find("max_iterations"), std::string::npos);
  EXPECT_NE(complaint({.rounds = 0}).find("rounds"), std::string::npos);
  EXPECT_NE(complaint({.huber = -1}).find("huber"), std::string::npos);
}

}  // namespace
}  // namespace alidade::sim3_refine_test
