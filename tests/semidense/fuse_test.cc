#include "alidade/semidense/fuse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/semidense/candidates.h"

namespace alidade::fuse_test {
namespace {

constexpr float kChi2 = 5.99f;

TEST(Fuse, IsTheMeanByInverseVariance) {
  const std::vector<Hypothesis> h = {{1.00f, 0.1f}, {1.04f, 0.2f}, {0.98f, 0.1f}};
  const Hypothesis fused = Fuse(h, kChi2, 3);
  // Weights 100, 25, 100.
  EXPECT_NEAR(fused.inverse_depth, (100 * 1.00 + 25 * 1.04 + 100 * 0.98) / 225, 1e-6);
  EXPECT_NEAR(fused.sigma, 1 / std::sqrt(225.0), 1e-6);
}

TEST(Fuse, TakesTheLargestSetThatAgrees) {
  const std::vector<Hypothesis> h = {
      {2.0f, 0.01f}, {1.00f, 0.02f}, {2.01f, 0.01f}, {1.01f, 0.02f}, {0.99f, 0.02f}};
  EXPECT_NEAR(Fuse(h, kChi2, 3).inverse_depth, 1.0, 1e-5);
  EXPECT_FALSE(Fuse(h, kChi2, 4).known());
}

TEST(Fuse, PassesOverWhatIsUnknown) {
  const std::vector<Hypothesis> h = {{}, {1.0f, 0.1f}, {}, {1.0f, 0.1f}};
  EXPECT_NEAR(Fuse(h, kChi2, 2).sigma, 0.1 / std::sqrt(2.0), 1e-6);
  EXPECT_FALSE(Fuse(h, kChi2, 3).known());
  EXPECT_FALSE(Fuse({}, kChi2, 1).known());
}

TEST(Fuse, FindsTheTruthAmongWrongMatches) {
  Random random(3);
  int right = 0, wrong = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    std::vector<Hypothesis> h;
    for (int k = 0; k < 7; ++k) {
      const bool outlier = k % 2 == 1;  // three of seven
      const double rho = outlier ? random.Uniform(0.2, 2.0) : 1.0 + 0.02 * random.Gaussian();
      h.push_back({static_cast<float>(rho), 0.02f});
    }
    const Hypothesis fused = Fuse(h, kChi2, 3);
    if (!fused.known()) continue;
    (std::abs(fused.inverse_depth - 1) < 0.06 ? right : wrong) += 1;
  }
  EXPECT_GE(right, 950);
  EXPECT_LE(wrong, 5);
}

TEST(Candidates, WithoutHypothesesTheWholeRangeIsSearched) {
  Candidates none(kChi2);
  none.Add({});
  const auto intervals = none.Around({0.1f, 2.0f});
  ASSERT_EQ(intervals.size(), 1u);
  EXPECT_EQ(intervals[0].min, 0.1f);
  EXPECT_EQ(intervals[0].max, 2.0f);
}

TEST(Candidates, EachGroupThatDiffersIsSearched) {
  Candidates some(kChi2);
  for (const Hypothesis& h : {Hypothesis{1.0f, 0.02f}, {0.5f, 0.01f}, {1.01f, 0.02f}}) some.Add(h);
  const auto intervals = some.Around({0.1f, 2.0f});
  ASSERT_EQ(intervals.size(), 2u);
  EXPECT_NEAR(intervals[0].min, 1.005 - 3 * 0.02 / std::sqrt(2.0), 1e-5);
  EXPECT_NEAR(intervals[0].max, 1.005 + 3 * 0.02 / std::sqrt(2.0), 1e-5);
  EXPECT_NEAR(intervals[1].min, 0.47, 1e-5);
  EXPECT_NEAR(intervals[1].max, 0.53, 1e-5);
}

TEST(Candidates, AreSearchedWithinTheRange) {
  Candidates near(kChi2);
  near.Add({0.11f, 0.02f});
  EXPECT_EQ(near.Around({0.1f, 2.0f})[0].min, 0.1f);
}

}  // namespace
}  // namespace alidade::fuse_test
