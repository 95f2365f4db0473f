// Times of the parts of a frame: each without the parts inside it, and together all of it.
#include "alidade/base/part_times.h"

#include <gtest/gtest.h>

#include <numeric>
#include <thread>

#include "alidade/base/timing.h"

namespace alidade::part_times_test {
namespace {

// Returns after at least a millisecond.
void Work() {
  const Stopwatch watch;
  while (watch.Milliseconds() < 1) {
  }
}

double At(const std::array<double, kFrameParts>& times, FramePart part) {
  return times[static_cast<size_t>(part)];
}

TEST(PartTimes, AreWithoutThePartsInside) {
  const Stopwatch around;
  PartTimes times;
  const Stopwatch inside;
  {
    const PartTimer pose(FramePart::kPose);
    Work();
    {
      const PartTimer search(FramePart::kLocalSearch);
      Work();
      Work();
    }
    Work();
  }
  const double least = inside.Milliseconds();
  const std::array<double, kFrameParts> taken = times.Take();
  const double most = around.Milliseconds();
  const double sum = std::accumulate(taken.begin(), taken.end(), 0.0);
  EXPECT_GE(sum, least);
  EXPECT_LE(sum, most + 1e-9);
  EXPECT_GE(At(taken, FramePart::kPose), 2);
  EXPECT_GE(At(taken, FramePart::kLocalSearch), 2);
  EXPECT_LE(At(taken, FramePart::kPose), most - At(taken, FramePart::kLocalSearch) + 1e-9);
  EXPECT_EQ(At(taken, FramePart::kGlance), 0);
  EXPECT_EQ(At(times.Take(), FramePart::kPose), 0);  // since the last call
}

TEST(PartTimes, AreThoseOfOneThread) {
  PartTimes times;
  std::thread([] {
    const PartTimer pose(FramePart::kPose);
    Work();
  }).join();
  EXPECT_EQ(At(times.Take(), FramePart::kPose), 0);
}

TEST(PartTimes, NothingIsMeasuredWhereNobodyAsks) {
  const PartTimer before(FramePart::kPose);
  PartTimes times;
  { const PartTimer nested(FramePart::kSpread); }
  EXPECT_GT(At(times.Take(), FramePart::kSpread), 0);
  for (int i = 0; i < kFrameParts; ++i) EXPECT_STRNE(NameOf(static_cast<FramePart>(i)), "");
}

}  // namespace
}  // namespace alidade::part_times_test
