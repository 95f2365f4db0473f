#include "alidade/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace alidade::random_test {
namespace {

TEST(Random, IsPcg32) {
  // Output of the reference implementation's demo for seed 42, stream 54.
  Random random(42, 54);
  for (const uint32_t expected :
       {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu}) {
    EXPECT_EQ(random.Next(), expected);
  }
}

TEST(Random, RepeatsItselfAndDiffersByStream) {
  Random a(7, 1), b(7, 1), c(7, 2);
  int same = 0;
  for (int i = 0; i < 100; ++i) {
    const uint32_t drawn = a.Next();
    EXPECT_EQ(drawn, b.Next());
    same += drawn == c.Next();
  }
  EXPECT_LE(same, 1);
}

TEST(Random, DrawsBelowABoundEvenly) {
  Random random(3);
  std::vector<int> counts(7, 0);
  for (int i = 0; i < 70000; ++i) {
    const uint32_t drawn = random.Below(7);
    ASSERT_LT(drawn, 7u);
    ++counts[drawn];
  }
  double chi2 = 0;
  for (const int count : counts) chi2 += (count - 10000.0) * (count - 10000.0) / 10000.0;
  EXPECT_LT(chi2, 22.5);  // 99.9 % of chi² with 6 degrees of freedom
  EXPECT_EQ(random.Below(1), 0u);
}

TEST(Random, IsUniformBetweenZeroAndOne) {
  Random random(4);
  double sum = 0, squares = 0, low = 1, high = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.Uniform();
    sum += x;
    squares += x * x;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  EXPECT_GE(low, 0);
  EXPECT_LT(high, 1);
  EXPECT_LT(low, 1e-3);
  EXPECT_GT(high, 1 - 1e-3);
  EXPECT_NEAR(sum / kCount, 0.5, 4 * std::sqrt(1.0 / 12 / kCount));
  EXPECT_NEAR(squares / kCount, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / kCount));
}

TEST(Random, IsNormalWithUnitVariance) {
  Random random(5);
  double sum = 0, squares = 0, fourth = 0;
  int beyond_two = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.Gaussian();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    beyond_two += std::abs(x) > 2;
  }
  EXPECT_NEAR(sum / kCount, 0, 4 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1, 4 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(fourth / kCount, 3, 4 * std::sqrt(96.0 / kCount));
  EXPECT_NEAR(beyond_two / static_cast<double>(kCount), 0.0455, 0.003);
}

TEST(Random, SamplesWithoutRepetition) {
  Random random(6);
  std::vector<int> counts(20, 0);
  for (int trial = 0; trial < 5000; ++trial) {
    const std::vector<int> sample = random.Sample(8, 20);
    ASSERT_EQ(sample.size(), 8u);
    EXPECT_EQ(std::set<int>(sample.begin(), sample.end()).size(), 8u);
    for (const int i : sample) {
      ASSERT_TRUE(0 <= i && i < 20);
      ++counts[i];
    }
  }
  // Binomial with p = 0.4; bound of four standard deviations.
  for (const int count : counts) EXPECT_NEAR(count, 2000, 4 * std::sqrt(5000 * 0.4 * 0.6));
  std::vector<int> all = random.Sample(20, 20);
  std::sort(all.begin(), all.end());
  for (int i = 0; i < 20; ++i) EXPECT_EQ(all[i], i);
}

}  // namespace
}  // namespace alidade::random_test
