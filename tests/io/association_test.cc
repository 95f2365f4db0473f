#include "alidade/io/association.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "alidade/base/random.h"

namespace alidade::association_test {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

// The definition: repeatedly takes the closest remaining pair.
Pairs AssociateSlowly(const std::vector<double>& a, const std::vector<double>& b, double max_dt) {
  std::vector<bool> taken_a(a.size()), taken_b(b.size());
  Pairs pairs;
  while (true) {
    double best = max_dt;
    std::pair<int, int> pair{-1, -1};
    for (size_t i = 0; i < a.size(); ++i) {
      for (size_t j = 0; j < b.size(); ++j) {
        if (taken_a[i] || taken_b[j] || !(std::abs(a[i] - b[j]) < best)) continue;
        best = std::abs(a[i] - b[j]);
        pair = {static_cast<int>(i), static_cast<int>(j)};
      }
    }
    if (pair.first < 0) break;
    taken_a[static_cast<size_t>(pair.first)] = taken_b[static_cast<size_t>(pair.second)] = true;
    pairs.push_back(pair);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(AssociateByTime, TakesTheBestPairFirstAndEachOnce) {
  const std::vector<double> a = {0.00, 0.10, 0.11}, b = {0.109, 0.02, 0.30};
  EXPECT_EQ(AssociateByTime(a, b, 0.05), (Pairs{{0, 1}, {2, 0}}));
}

TEST(AssociateByTime, AgreesWithItsDefinitionOnRandomLists) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> a(60), b(50);
    for (double& t : a) t = random.Uniform(0, 2);
    for (double& t : b) t = random.Uniform(0, 2);
    EXPECT_EQ(AssociateByTime(a, b, 0.05), AssociateSlowly(a, b, 0.05));
  }
}

// Few distinct times, so many pairs are equally close; the first one is taken.
TEST(AssociateByTime, AgreesWithItsDefinitionWhereTimesAreEqual) {
  Random random(4);
  for (int round = 0; round < 50; ++round) {
    std::vector<double> a(30), b(40);
    for (double& t : a) t = random.Below(20);
    for (double& t : b) t = random.Below(20);
    for (const double max_dt : {0.0, 1.0, 2.5, 100.0})
      EXPECT_EQ(AssociateByTime(a, b, max_dt), AssociateSlowly(a, b, max_dt)) << max_dt;
  }
}

// Every item of one list is near every item of the other: there are 10^11 pairs.
TEST(AssociateByTime, ManyTimesThatLieCloseTogetherNeedNoMoreThanTheirNumber) {
  constexpr int kMany = 300000;
  std::vector<double> a(kMany), b(kMany);
  for (int i = 0; i < kMany; ++i) {
    a[static_cast<size_t>(i)] = 1e-9 * i;
    b[static_cast<size_t>(i)] = 0.01 + 1e-9 * (i / 3);
  }
  EXPECT_EQ(AssociateByTime(a, b, 0.02).size(), static_cast<size_t>(kMany));
}

TEST(AssociateByTime, NothingMatchesNanOrNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> a = {nan, 1.0}, b = {nan, 1.0};
  EXPECT_EQ(AssociateByTime(a, b, 0.1), (Pairs{{1, 1}}));
  EXPECT_TRUE(AssociateByTime(a, {}, 0.1).empty());
}

}  // namespace
}  // namespace alidade::association_test
