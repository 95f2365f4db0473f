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

TEST(SampleLog, KeepsAllUpToItsBoundAndThenAPartThatIsSpreadEvenly) {
  SampleLog log(64);
  for (int i = 0; i < 64; ++i) log.Add(i);
  std::vector<double> kept = log.All();
  ASSERT_EQ(kept.size(), 64u);
  for (int i = 0; i < 64; ++i) EXPECT_EQ(kept[i], i);
  for (int i = 64; i < 100000; ++i) {
    log.Add(i);
    if (i % 997 == 0) {
      EXPECT_LE(log.All().size(), 64u);
      EXPECT_GE(log.All().size(), 31u);
    }
  }
  kept = log.All();
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  // Each sample is drawn uniformly from an interval of 2048: neighbors are less than two intervals
  // apart, and the median differs from that of all samples by at most that.
  for (size_t i = 1; i < kept.size(); ++i) EXPECT_LT(kept[i] - kept[i - 1], 2 * 2048);
  EXPECT_NEAR(Summarise(kept).median, 50000, 2 * 2048);
}

// Periodic input, e.g. a detector that runs on every fourth frame.
TEST(SampleLog, DoesNotFallInStepWithWhatRepeats) {
  SampleLog log(256);
  for (int i = 0; i < 40000; ++i) log.Add(i % 4 == 0 ? 100 : 1);
  const std::vector<double> kept = log.All();
  const auto share = static_cast<double>(std::count(kept.begin(), kept.end(), 100.0)) /
                     static_cast<double>(kept.size());
  EXPECT_NEAR(share, 0.25, 0.12);  // four standard deviations for at least 128 samples
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
