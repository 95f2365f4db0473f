#include "alidade/geometry/sim3_ransac.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "alidade/base/error.h"
#include "problems/sim3_problem.h"
#include "support/expect_error.h"

namespace alidade::sim3_ransac_test {
namespace {

double Angle(const Sim3& a, const Sim3& b) { return LogSo3(a.R.transpose() * b.R).norm(); }

TEST(SolveSim3Ransac, FindsTheSimilarityAmongHalfToSeventyPercentWrongMatches) {
  for (const double outliers : {0.5, 0.6, 0.7}) {
    for (uint64_t seed = 1; seed <= 20; ++seed) {
      const Sim3Problem problem = MakeSim3Problem(
          {.matches = 120, .outliers = outliers, .scale = 0.5 + 0.1 * seed, .seed = seed});
      const Sim3RansacResult result =
          SolveSim3Ransac(problem.camera, problem.matches, {.seed = seed});
      ASSERT_TRUE(result.success) << outliers << " " << seed;
      // 36 points with 1 % depth error: scale within a few thousandths, rotation within a few mrad.
      EXPECT_NEAR(result.T_a_b.s / problem.truth.s, 1, 0.03) << outliers << " " << seed;
      EXPECT_LT(Angle(result.T_a_b, problem.truth), 0.02) << outliers << " " << seed;
      EXPECT_LT((result.T_a_b.t - problem.truth.t).norm(), 0.1) << outliers << " " << seed;
      int wrong = 0, right = 0;
      for (size_t i = 0; i < problem.matches.size(); ++i) {
        wrong += result.inlier[i] && problem.outlier[i];
        right += result.inlier[i] && !problem.outlier[i];
      }
      EXPECT_LE(wrong, 2) << outliers << " " << seed;
      EXPECT_GE(right, 0.8 * (result.inliers - wrong)) << outliers << " " << seed;
      EXPECT_EQ(result.inliers, std::count(result.inlier.begin(), result.inlier.end(), true));
    }
  }
}

TEST(SolveSim3Ransac, HoldsTheScaleAtOneWhereItIsKnown) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Sim3Problem problem =
        MakeSim3Problem({.matches = 100, .outliers = 0.5, .scale = 1, .seed = seed});
    const Sim3RansacResult result =
        SolveSim3Ransac(problem.camera, problem.matches, {.with_scale = false});
    ASSERT_TRUE(result.success) << seed;
    EXPECT_EQ(result.T_a_b.s, 1) << seed;
    EXPECT_LT(Angle(result.T_a_b, problem.truth), 0.02) << seed;
  }
}

TEST(SolveSim3Ransac, FindsNothingWhereAllMatchesAreWrong) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const Sim3Problem problem = MakeSim3Problem({.matches = 60, .outliers = 1, .seed = seed});
    const Sim3RansacResult result = SolveSim3Ransac(problem.camera, problem.matches);
    EXPECT_FALSE(result.success) << seed << ": " << result.inliers;
  }
}

TEST(SolveSim3Ransac, DegeneratePointsGiveNoAnswer) {
  const Sim3Problem good = MakeSim3Problem({.matches = 40, .seed = 3});
  std::vector<Sim3Match> matches = good.matches;
  for (Sim3Match& m : matches) m = good.matches[0];
  EXPECT_FALSE(SolveSim3Ransac(good.camera, matches).success);  // all points identical

  const Sim3 T_b_a = good.truth.Inverse();
  for (size_t i = 0; i < matches.size(); ++i) {  // collinear points
    Sim3Match& m = matches[i];
    m.p_a = Eigen::Vector3d(-0.5, 0.1, 3) +
            0.02 * static_cast<double>(i) * Eigen::Vector3d(1, 0.2, 0.4);
    m.p_b = T_b_a * m.p_a;
    m.pixel_a = good.camera.Project(m.p_a);
    m.pixel_b = good.camera.Project(m.p_b);
  }
  EXPECT_FALSE(SolveSim3Ransac(good.camera, matches).success);

  matches.assign(good.matches.begin(), good.matches.begin() + 14);
  EXPECT_FALSE(SolveSim3Ransac(good.camera, matches).success);  // too few
  EXPECT_EQ(SolveSim3Ransac(good.camera, matches).inlier, std::vector<bool>(14, false));
  EXPECT_FALSE(SolveSim3Ransac(good.camera, {}).success);
}

TEST(SolveSim3Ransac, LooksPastMatchesThatAreNotNumbers) {
  Sim3Problem problem = MakeSim3Problem({.matches = 60, .seed = 4});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  problem.matches[0].p_a.x() = nan;
  problem.matches[1].p_b.z() = inf;
  problem.matches[2].pixel_a.x() = nan;
  problem.matches[3].pixel_b.y() = -inf;
  problem.matches[4].sigma_a = nan;
  problem.matches[5].sigma_b = 0;
  problem.matches[6].p_a = -problem.matches[6].p_a;  // behind the camera
  const Sim3RansacResult result = SolveSim3Ransac(problem.camera, problem.matches);
  EXPECT_TRUE(result.success);
  for (int i = 0; i < 7; ++i) EXPECT_FALSE(result.inlier[i]) << i;
  EXPECT_NEAR(result.T_a_b.s, problem.truth.s, 0.03);
}

TEST(SolveSim3Ransac, SameSeedSameAnswer) {
  const Sim3Problem problem = MakeSim3Problem({.outliers = 0.6, .seed = 5});
  const Sim3RansacResult one = SolveSim3Ransac(problem.camera, problem.matches),
                         two = SolveSim3Ransac(problem.camera, problem.matches);
  EXPECT_EQ(one.T_a_b.R, two.T_a_b.R);
  EXPECT_EQ(one.T_a_b.t, two.T_a_b.t);
  EXPECT_EQ(one.T_a_b.s, two.T_a_b.s);
  EXPECT_EQ(one.inlier, two.inlier);
}

TEST(SolveSim3Ransac, SettingsThatCannotBeAreNamed) {
  const auto complaint = ComplaintAbout<Sim3RansacSettings>;
  EXPECT_EQ(complaint({}), "");
  EXPECT_NE(complaint({.max_iterations = 0}).find("max_iterations"), std::string::npos);
  EXPECT_NE(complaint({.max_error = -1}).find("max_error"), std::string::npos);
  EXPECT_NE(complaint({.confidence = 1}).find("confidence"), std::string::npos);
  EXPECT_NE(complaint({.min_inliers = 2}).find("min_inliers"), std::string::npos);
}

}  // namespace
}  // namespace alidade::sim3_ransac_test
