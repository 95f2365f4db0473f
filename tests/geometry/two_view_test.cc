#include "alidade/geometry/two_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "alidade/base/error.h"
#include "support/two_view_problem.h"

namespace alidade {
namespace {

double DirectionError(const Se3& found, const Se3& truth) {
  return std::acos(std::clamp(found.t.dot(truth.t.normalized()), -1.0, 1.0));
}

TwoViewResult Solve(const TwoViewProblem& problem, TwoViewSettings settings = {}) {
  return ReconstructTwoViews(problem.camera, problem.a, problem.b, settings);
}

TEST(ReconstructTwoViews, FindsMotionAndPointsOfAGeneralScene) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const TwoViewProblem problem =
        MakeTwoViewProblem({.outliers = 0.2, .noise_px = 0.5, .seed = seed});
    const TwoViewResult result = Solve(problem);
    ASSERT_EQ(result.failure, TwoViewFailure::kNone) << seed;
    EXPECT_FALSE(result.planar);
    EXPECT_NEAR(result.T_b_a.t.norm(), 1, 1e-12);
    EXPECT_LT(RotationAngle(result.T_b_a, problem.T_b_a), 0.01);
    EXPECT_LT(DirectionError(result.T_b_a, problem.T_b_a), 0.04);
    std::vector<double> scale;  // depth against the truth; the unit of the map is the baseline
    for (size_t i = 0; i < problem.a.size(); ++i) {
      EXPECT_EQ(result.inlier[i], result.p_a[i].allFinite());
      if (!result.inlier[i] || problem.outlier[i]) continue;
      scale.push_back(result.p_a[i].z() * problem.T_b_a.t.norm() / problem.p_a[i].z());
    }
    ASSERT_GT(scale.size(), 180u);
    std::sort(scale.begin(), scale.end());
    EXPECT_NEAR(scale[scale.size() / 2], 1, 0.1);
    // 5 m seen from 0.5 m apart is 50 pixels of parallax: half a pixel in each image is 1.5 %.
    EXPECT_LT(scale[scale.size() * 3 / 4] / scale[scale.size() / 4], 1.1);
  }
}

TEST(ReconstructTwoViews, GivesTheSameResultWithAndWithoutThreads) {
  const TwoViewProblem problem = MakeTwoViewProblem({.seed = 5});
  const TwoViewResult serial = Solve(problem, {.parallel = false}),
                      parallel = Solve(problem, {.parallel = true});
  EXPECT_EQ(serial.failure, parallel.failure);
  EXPECT_EQ(serial.T_b_a.R, parallel.T_b_a.R);
  EXPECT_EQ(serial.T_b_a.t, parallel.T_b_a.t);
  EXPECT_EQ(serial.inlier, parallel.inlier);
}

TEST(ReconstructTwoViews, RefusesACameraThatOnlyTurns) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const TwoViewResult result =
        Solve(MakeTwoViewProblem({.kind = SceneKind::kRotation, .outliers = 0, .seed = seed}));
    EXPECT_EQ(result.failure, TwoViewFailure::kLowParallax);
  }
}

TEST(ReconstructTwoViews, RefusesTooFewMatches) {
  const TwoViewProblem problem = MakeTwoViewProblem({.matches = 40, .seed = 5});
  EXPECT_EQ(Solve(problem).failure, TwoViewFailure::kTooFewMatches);
  EXPECT_EQ(ReconstructTwoViews(problem.camera, {}, {}).failure, TwoViewFailure::kTooFewMatches);
}

}  // namespace
}  // namespace alidade
