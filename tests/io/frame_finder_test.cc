#include "alidade/io/frame_finder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/base/random.h"
#include "support/expect_error.h"

namespace alidade::frame_finder_test {
namespace {

// Frames at the given times; counts the frames read.
class TimedSource : public FrameSource {
 public:
  explicit TimedSource(std::vector<double> times) : times_(std::move(times)) {
    info_.frames = static_cast<int>(times_.size());
    info_.camera.fps = 30;
  }
  const SourceInfo& Info() const override { return info_; }
  std::optional<SourceFrame> Next() override {
    if (next_ >= static_cast<int>(times_.size())) return std::nullopt;
    ++read;
    SourceFrame frame;
    frame.number = next_;
    frame.time = times_[static_cast<size_t>(next_)];
    if (next_ == bad) frame.problem = "damaged";
    ++next_;
    return frame;
  }
  bool Seek(int frames) override {
    next_ = frames;
    return seeks;
  }
  int read = 0;
  int bad = -1;
  bool seeks = true;

 private:
  SourceInfo info_;
  std::vector<double> times_;
  int next_ = 0;
};

// Times since 1970 at 30 Hz, some of them jittered, followed by gaps.
std::vector<double> UnevenTimes(int frames, uint64_t seed) {
  Random random(seed);
  std::vector<double> times;
  double time = 1305031910.7653;
  for (int i = 0; i < frames; ++i) {
    times.push_back(time + random.Uniform(-0.004, 0.004));
    time += i % 50 == 17 ? 1.5 : 1.0 / 30;
  }
  return times;
}

TEST(FrameFinder, ReadsOnlyTheFramesAskedForAtAnEvenRate) {
  std::vector<double> times;
  for (int i = 0; i < 600; ++i) times.push_back(i / 30.0);
  TimedSource source(times);
  FrameFinder finder(source);
  for (const int number : {12, 30, 31, 200, 599, 7}) {
    const auto frame = finder.Nearest(times[static_cast<size_t>(number)], 0.02);
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->number, number);
  }
  EXPECT_EQ(source.read, 7);  // plus one frame to find the start time
}

TEST(FrameFinder, AgreesWithLookingAtEveryFrameWhateverTheStamps) {
  const std::vector<double> times = UnevenTimes(300, 5);
  TimedSource source(times);
  FrameFinder finder(source);
  Random random(6);
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    const double time = random.Uniform(times.front() - 1, times.back() + 1);
    int nearest = 0;
    for (int k = 1; k < 300; ++k) {
      const auto at = [&](int n) { return std::abs(times[static_cast<size_t>(n)] - time); };
      if (at(k) < at(nearest)) nearest = k;
    }
    const auto frame = finder.Nearest(time, 0.02);
    const bool near = std::abs(times[static_cast<size_t>(nearest)] - time) <= 0.02;
    ASSERT_EQ(frame.has_value(), near) << i;
    if (near) {
      EXPECT_EQ(frame->number, nearest) << i;
    }
    found += near;
  }
  EXPECT_GT(found, 50);
}

TEST(FrameFinder, FindsUnevenStampsInAFewReads) {
  const std::vector<double> times = UnevenTimes(1000, 7);
  TimedSource source(times);
  FrameFinder finder(source);
  for (int i = 5; i < 1000; i += 20)
    EXPECT_EQ(finder.Nearest(times[static_cast<size_t>(i)], 0.02)->number, i);
  EXPECT_LT(source.read, 8 * 50);
}

TEST(FrameFinder, OfTwoFramesWithOneStampTheGoodOneIsFound) {
  // A line that repeats a stamp becomes a frame with a problem and the time of its predecessor.
  std::vector<double> times;
  for (int i = 0; i < 50; ++i) times.push_back((i < 21 ? i : i - 1) / 30.0);
  TimedSource source(times);
  source.bad = 21;
  FrameFinder finder(source);
  // Now the estimated index for stamp 20 is that of the later frame.
  finder.Nearest(times[49], 0.02);
  const auto frame = finder.Nearest(times[20], 0.02);
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->number, 20);
}

TEST(FrameFinder, EmptyAndLiveSourcesAreNoRecordings) {
  TimedSource empty({});
  EXPECT_FALSE(FrameFinder(empty).Nearest(0, 1).has_value());
  TimedSource live({0, 1});
  live.seeks = false;
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { FrameFinder finder(live); }),
              testing::HasSubstr("only be played from the start"));
}

}  // namespace
}  // namespace alidade::frame_finder_test
