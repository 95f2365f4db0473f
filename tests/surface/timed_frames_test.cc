#include "alidade/run/surface/timed_frames.h"

#include <gtest/gtest.h>

namespace alidade::timed_frames_test {
namespace {

// Frames at the given times; counts those that were read.
class CountedSource : public FrameSource {
 public:
  CountedSource(std::vector<double> times, const std::string& kind, int& reads)
      : times_(std::move(times)), reads_(reads) {
    info_.kind = kind;
    info_.frames = static_cast<int>(times_.size());
  }
  const SourceInfo& Info() const override { return info_; }
  std::optional<SourceFrame> Next() override {
    if (next_ >= times_.size()) return std::nullopt;
    ++reads_;
    SourceFrame frame;
    frame.number = static_cast<int>(next_);
    frame.time = times_[next_++];
    return frame;
  }
  bool Seek(int frame) override {
    next_ = static_cast<size_t>(frame);
    return true;
  }

 private:
  SourceInfo info_;
  std::vector<double> times_;
  size_t next_ = 0;
  int& reads_;
};

std::vector<int> NumbersAt(const std::vector<double>& times, const std::string& kind,
                           const std::vector<double>& wanted, int& reads) {
  TimedFrames frames(std::make_unique<CountedSource>(times, kind, reads), wanted);
  std::vector<int> numbers;
  while (const auto frame = frames.Next()) numbers.push_back(frame->number);
  return numbers;
}

std::vector<double> Regular(int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(100 + i / 30.0);
  return times;
}

TEST(TimedFrames, AreFoundAtOnceInARegularRecording) {
  const auto times = Regular(1000);
  int reads = 0;
  EXPECT_EQ(NumbersAt(times, "tum", {times[0], times[40], times[41], times[999]}, reads),
            (std::vector<int>{0, 40, 41, 999}));
  EXPECT_LE(reads, 5);
}

TEST(TimedFrames, AreFoundBesideGapsAndWrongRates) {
  std::vector<double> times = {0};
  for (int i = 1; i < 500; ++i) times.push_back(times.back() + (i % 97 == 0 ? 20 : 0.08));
  int reads = 0;
  std::vector<double> wanted;
  std::vector<int> numbers;
  for (int i = 3; i < 500; i += 31) {
    wanted.push_back(times[static_cast<size_t>(i)]);
    numbers.push_back(i);
  }
  wanted.push_back(1e9);  // is not there
  EXPECT_EQ(NumbersAt(times, "images", wanted, reads), numbers);
  EXPECT_LT(reads, 120);
}

TEST(TimedFrames, OfVideosAllAreRead) {
  const auto times = Regular(50);
  int reads = 0;
  EXPECT_EQ(NumbersAt(times, "video", {times[7], times[30]}, reads), (std::vector<int>{7, 30}));
  EXPECT_EQ(reads, 50);
}

}  // namespace
}  // namespace alidade::timed_frames_test
