#include "alidade/base/median.h"

#include <gtest/gtest.h>

#include <array>
#include <span>
#include <vector>

#include "alidade/base/random.h"

namespace alidade::median_test {
namespace {

TEST(UpperMedian, HasAsManyBelowAsAbove) {
  Random random(3);
  for (size_t count : {1, 2, 3, 10, 101}) {
    std::vector<double> values;
    for (size_t i = 0; i < count; ++i) values.push_back(random.Uniform(-1, 1));
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(UpperMedian(values), sorted[count / 2]) << count;
  }
}

TEST(UpperMedian, IsTheLargerOfTheMiddleTwo) {
  EXPECT_EQ(UpperMedian(std::vector<int>{7, 1, 3, 5}), 5);
  EXPECT_EQ(UpperMedian(std::vector<int>{2, 2, 9}), 2);
}

TEST(UpperMedian, IsOfThePartThatIsGiven) {
  std::array<float, 5> values = {4, 2, 3, 100, 100};
  EXPECT_EQ(UpperMedian(std::span(values).first(3)), 3);
  EXPECT_EQ(values[3], 100);
}

}  // namespace
}  // namespace alidade::median_test
