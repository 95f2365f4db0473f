#include "alidade/base/timing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace alidade::timing_test {
namespace {

TEST(Summarise, GivesNearestRankStatistics) {
  std::vector<double> samples;
  for (int i = 100; i >= 1; --i) samples.push_back(i);
  const Summary summary = Summarise(samples);
  EXPECT_EQ(summary.count, 100);
  EXPECT_EQ(summary.median, 50);
  EXPECT_EQ(summary.p95, 95);
  EXPECT_EQ(summary.max, 100);
  EXPECT_DOUBLE_EQ(summary.mean, 50.5);
}

TEST(Summarise, CopesWithFewSamples) {
  EXPECT_EQ(Summarise({}).count, 0);
  EXPECT_EQ(Summarise({}).max, 0);
  const Summary one = Summarise({3});
  EXPECT_EQ(one.median, 3);
  EXPECT_EQ(one.p95, 3);
  const Summary two = Summarise({5, 1});
  EXPECT_EQ(two.median, 1);
  EXPECT_EQ(two.p95, 5);
}

TEST(Stopwatch, DoesNotRunBackwards) {
  const Stopwatch watch;
  const double first = watch.Milliseconds();
  EXPECT_GE(first, 0);
  EXPECT_GE(watch.Milliseconds(), first);
}

TEST(ProcessCpuSeconds, GrowsWithWork) {
  const double before = ProcessCpuSeconds();
  volatile double sum = 0;
  for (int i = 0; i < 20000000; ++i) sum = sum + i;
  EXPECT_GT(ProcessCpuSeconds(), before);
}

TEST(PeakMegabytes, SeesAnAllocation) {
  const double before = PeakMegabytes();
  if (before == 0) GTEST_SKIP() << "not known on this system";
  const auto size = static_cast<size_t>((before + 50) * 1e6);
  const std::vector<char> large(size, 1);
  EXPECT_GT(PeakMegabytes(), before + 40);
  EXPECT_EQ(large.back(), 1);
}

}  // namespace
}  // namespace alidade::timing_test
