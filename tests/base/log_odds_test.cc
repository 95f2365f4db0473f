#include "alidade/base/log_odds.h"

#include <gtest/gtest.h>

namespace alidade::log_odds_test {
namespace {

TEST(LogOdds, AreZeroForEvenChances) {
  EXPECT_EQ(ProbabilityOf(0), 0.5f);
  EXPECT_EQ(LogOddsOf(0.5f), 0);
  EXPECT_FLOAT_EQ(LogOddsOf(0.75f), std::log(3.0f));  // odds of three to one
  EXPECT_FLOAT_EQ(ProbabilityOf(-std::log(3.0f)), 0.25f);
}

TEST(LogOdds, LeadBackToTheProbability) {
  for (float p = 0.01f; p < 1; p += 0.01f) EXPECT_NEAR(ProbabilityOf(LogOddsOf(p)), p, 1e-6f);
}

TEST(LogOdds, HoweverLargeAreNeverMoreThanCertain) {
  EXPECT_EQ(ProbabilityOf(1000), 1);
  EXPECT_EQ(ProbabilityOf(-1000), 0);
}

}  // namespace
}  // namespace alidade::log_odds_test
