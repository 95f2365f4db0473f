#include "alidade/base/parallel.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace alidade::parallel_test {
namespace {

class ParallelForTest : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { SetThreadCount(GetParam()); }
  void TearDown() override { SetThreadCount(0); }
};

TEST_P(ParallelForTest, VisitsEachIndexOnce) {
  for (const int count : {0, 1, 2, 3, 17, 1000}) {
    std::vector<int> visits(count, 0);
    ParallelFor(count, [&](int i) { ++visits[i]; });
    EXPECT_EQ(visits, std::vector<int>(count, 1));
  }
  ParallelFor(-3, [](int) { FAIL(); });
}

TEST_P(ParallelForTest, ManyShortLoopsFollowEachOther) {
  int64_t total = 0;
  for (int loop = 0; loop < 5000; ++loop) {
    std::vector<int> values(1 + loop % 9, 0);
    ParallelFor(static_cast<int>(values.size()), [&](int i) { values[i] = i + loop; });
    for (size_t i = 0; i < values.size(); ++i) total += values[i] - static_cast<int>(i) - loop;
  }
  EXPECT_EQ(total, 0);
}

TEST_P(ParallelForTest, ThrowsWhatABodyThrewAndWorksAgain) {
  for (int trial = 0; trial < 50; ++trial) {
    EXPECT_THROW(ParallelFor(100,
                             [](int i) {
                               if (i == 37) throw std::runtime_error("37");
                             }),
                 std::runtime_error);
    std::atomic<int> sum{0};
    ParallelFor(100, [&](int i) { sum += i; });
    EXPECT_EQ(sum, 4950);
  }
}

TEST_P(ParallelForTest, RunsLoopsInsideLoops) {
  std::vector<std::vector<int>> table(20, std::vector<int>(30, 0));
  ParallelFor(20, [&](int i) { ParallelFor(30, [&](int k) { table[i][k] += i * 30 + k; }); });
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 30; ++k) EXPECT_EQ(table[i][k], i * 30 + k);
  }
}

TEST_P(ParallelForTest, ServesSeveralThreadsAtOnce) {
  std::vector<std::thread> callers;
  std::vector<int64_t> sums(4, 0);
  for (int caller = 0; caller < 4; ++caller) {
    callers.emplace_back([&, caller] {
      for (int loop = 0; loop < 300; ++loop) {
        std::vector<int> values(50, 0);
        ParallelFor(50, [&](int i) { values[i] = i; });
        for (const int value : values) sums[caller] += value;
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  for (const int64_t sum : sums) EXPECT_EQ(sum, 300 * 1225);
}

TEST_P(ParallelForTest, UsesAsManyThreadsAsItWasTold) {
  std::mutex mutex;
  std::set<std::thread::id> seen;
  // Bodies that sleep give every worker time to join.
  ParallelFor(16, [&](int) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::lock_guard<std::mutex> lock(mutex);
    seen.insert(std::this_thread::get_id());
  });
  EXPECT_LE(static_cast<int>(seen.size()), GetParam());
  EXPECT_GE(seen.size(), GetParam() > 1 ? 2u : 1u);
}

TEST_P(ParallelForTest, FollowsAChangeOfThreadCount) {
  for (int threads : {1, 3, 2, 4, 1, 2}) {
    SetThreadCount(threads);
    EXPECT_EQ(ThreadCount(), threads);
    std::atomic<int> sum{0};
    ParallelFor(64, [&](int i) { sum += i; });
    EXPECT_EQ(sum, 2016);
  }
}

#ifndef __SANITIZE_THREAD__
// The child has no copy of the threads; it runs loops, and ends as usual.
TEST_P(ParallelForTest, WorksInAForkedProcess) {
  ParallelFor(64, [](int) {});
  const pid_t child = fork();
  if (child == 0) {
    std::atomic<int> sum{0};
    for (int round = 0; round < 10; ++round) ParallelFor(64, [&](int i) { sum += i; });
    std::exit(sum == 20160 ? 7 : 1);
  }
  int status = 0, waited = 0;
  while (waitpid(child, &status, WNOHANG) == 0 && ++waited < 6000)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (waited == 6000) kill(child, SIGKILL);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7)
      << "after " << waited << " times 10 ms";
}
#endif

INSTANTIATE_TEST_SUITE_P(Threads, ParallelForTest, testing::Values(1, 2, 4));

TEST(ThreadCount, IsAtLeastOne) {
  SetThreadCount(0);
  EXPECT_GE(ThreadCount(), 1);
  SetThreadCount(-5);
  EXPECT_GE(ThreadCount(), 1);
  SetThreadCount(0);
}

}  // namespace
}  // namespace alidade::parallel_test
