#include "alidade/evaluation/association.h"

#include <gtest/gtest.h>

#include <vector>

namespace alidade::association_test {
namespace {

TEST(TumAssociation, GivesTheClosestPairItsWayFirst) {
  // 0.010 is the nearest for both estimates; the second estimate is closer and gets it, the first
  // gets 0.
  const std::vector<double> truth = {0.000, 0.010};
  const std::vector<double> estimate = {0.006, 0.011};
  const auto pairs = AssociateStamps(truth, estimate, 0.02, Association::kTum);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].truth, 0);
  EXPECT_EQ(pairs[0].estimate, 0);
  EXPECT_EQ(pairs[1].truth, 1);
  EXPECT_EQ(pairs[1].estimate, 1);
}

TEST(TumAssociation, NeverUsesAPoseTwice) {
  const std::vector<double> truth = {1.0};
  const std::vector<double> estimate = {0.99, 1.001, 1.002};
  const auto pairs = AssociateStamps(truth, estimate, 0.02, Association::kTum);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].estimate, 1);
}

TEST(TumAssociation, IsStrictAboutTheLargestDifference) {
  const std::vector<double> truth = {1.0};
  const std::vector<double> estimate = {1.25};
  EXPECT_EQ(AssociateStamps(truth, estimate, 0.25, Association::kTum).size(), 0u);
  EXPECT_EQ(AssociateStamps(truth, estimate, 0.26, Association::kTum).size(), 1u);
}

TEST(EvoAssociation, GivesEachStampOfTheShorterListItsNearest) {
  const std::vector<double> truth = {0.000, 0.010, 0.020};
  const std::vector<double> estimate = {0.006, 0.011};
  const auto pairs = AssociateStamps(truth, estimate, 0.02, Association::kEvo);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].truth, 1);  // evo may use a stamp twice
  EXPECT_EQ(pairs[1].truth, 1);
}

TEST(EvoAssociation, LooksFromTheTruthWhenThatIsShorter) {
  const std::vector<double> truth = {0.5};
  const std::vector<double> estimate = {0.1, 0.45, 0.9};
  const auto pairs = AssociateStamps(truth, estimate, 0.05, Association::kEvo);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].estimate, 1);
}

TEST(NearestStamp, TakesTheEarlierOfTwoEquallyNear) {
  const std::vector<double> stamps = {0.0, 1.0, 2.0};
  EXPECT_EQ(NearestStamp(stamps, -5), 0);
  EXPECT_EQ(NearestStamp(stamps, 0.5), 0);
  EXPECT_EQ(NearestStamp(stamps, 0.51), 1);
  EXPECT_EQ(NearestStamp(stamps, 9), 2);
}

}  // namespace
}  // namespace alidade::association_test
