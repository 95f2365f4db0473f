#include "alidade/io/wrappers.h"

#include <gtest/gtest.h>

#include <future>

#include "alidade/base/timing.h"
#include "alidade/io/read_ahead.h"
#include "support/expect_error.h"

namespace alidade::wrappers_test {
namespace {

// Frames at uneven times; counts the calls.
class ListSource : public FrameSource {
 public:
  ListSource(int frames, bool knows_length, bool seeks) : frames_(frames), seeks_(seeks) {
    info_.frames = knows_length ? frames : -1;
  }
  static double TimeOf(int i) { return 10 + i + 0.001 * i * i; }

  const SourceInfo& Info() const override { return info_; }
  std::optional<SourceFrame> Next() override {
    if (next_ == fail_at) throw Error(ErrorKind::kInput, "the disk is gone");
    if (next_ >= frames_) return std::nullopt;
    SourceFrame frame;
    frame.number = next_;
    frame.time = TimeOf(next_);
    frame.stamp = "stamp " + std::to_string(next_);
    frame.image = cv::Mat(1, 1, CV_8UC1, cv::Scalar(next_ % 256));
    ++next_;
    return frame;
  }
  bool Seek(int frames) override {
    if (seeks_) next_ = frames;
    return seeks_;
  }
  int fail_at = -1;

 private:
  SourceInfo info_;
  int frames_, next_ = 0;
  bool seeks_;
};

std::vector<SourceFrame> AllFrames(FrameSource& source) {
  std::vector<SourceFrame> frames;
  while (auto frame = source.Next()) frames.push_back(*frame);
  return frames;
}

TEST(Clip, WorksWithAndWithoutSeeking) {
  for (const bool seeks : {false, true}) {
    const auto source = Clip(std::make_unique<ListSource>(10, seeks, seeks), 3, 6);
    const auto frames = AllFrames(*source);
    ASSERT_EQ(frames.size(), 4u);
    EXPECT_EQ(frames.front().number, 3);
    EXPECT_EQ(frames.back().stamp, "stamp 6");
    EXPECT_EQ(source->Info().frames, seeks ? 4 : -1);
    EXPECT_THAT(MessageOf(ErrorKind::kInput,
                          [&] { Clip(std::make_unique<ListSource>(10, seeks, seeks), 10, -1); }),
                testing::HasSubstr("past the end"));
  }
}

TEST(Repeat, PlaysForthAndBackWithTimesGoingOn) {
  for (const int length : {2, 5, 70}) {  // 70: more than one block when played backwards
    for (const int times : {1, 2}) {
      const auto source = Repeat(std::make_unique<ListSource>(length, true, true), times);
      const auto frames = AllFrames(*source);
      ASSERT_EQ(static_cast<int>(frames.size()), 1 + 2 * times * (length - 1));
      EXPECT_EQ(source->Info().frames, static_cast<int>(frames.size()));
      int index = 0, direction = 1;
      for (size_t i = 0; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].number, static_cast<int>(i));
        EXPECT_EQ(frames[i].image.at<uchar>(0, 0), index);
        if (i > 0) {
          const double step =
              std::abs(ListSource::TimeOf(index) - ListSource::TimeOf(index - direction));
          EXPECT_NEAR(frames[i].time - frames[i - 1].time, step, 1e-9);
          EXPECT_NE(frames[i].stamp, frames[i - 1].stamp);
        }
        if (index + direction < 0 || index + direction >= length) direction = -direction;
        index += direction;
      }
    }
  }
}

TEST(Repeat, OfOneFrameOrNoneIsThat) {
  EXPECT_EQ(AllFrames(*Repeat(std::make_unique<ListSource>(1, true, true), 3)).size(), 1u);
  EXPECT_EQ(AllFrames(*Repeat(std::make_unique<ListSource>(0, true, true), 3)).size(), 0u);
}

TEST(Repeat, OfAPartStaysInThePart) {
  const auto frames =
      AllFrames(*Repeat(Clip(std::make_unique<ListSource>(10, true, true), 4, 6), 1));
  ASSERT_EQ(frames.size(), 5u);
  const int expected[] = {4, 5, 6, 5, 4};
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(frames[i].image.at<uchar>(0, 0), expected[i]);
    EXPECT_EQ(frames[i].number, 4 + static_cast<int>(i));
  }
}

TEST(Repeat, OfWhatCannotSeekIsAUsageError) {
  const auto source = Repeat(std::make_unique<ListSource>(3, false, false), 1);
  MessageOf(ErrorKind::kUsage, [&] { AllFrames(*source); });
}

TEST(ReadAhead, GivesTheSameFramesInOrder) {
  ReadAhead source(std::make_unique<ListSource>(100, true, true), 4);
  const auto frames = AllFrames(source);
  ASSERT_EQ(frames.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(frames[static_cast<size_t>(i)].number, i);
  EXPECT_FALSE(source.Next());
  EXPECT_GT(source.ReadCpuSeconds(), 0);
}

TEST(ReadAhead, HandsOnFailuresAfterTheFramesBefore) {
  auto failing = std::make_unique<ListSource>(10, true, true);
  failing->fail_at = 3;
  ReadAhead source(std::move(failing));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(source.Next());
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { source.Next(); }),
              testing::HasSubstr("disk is gone"));
  EXPECT_FALSE(source.Next());
}

TEST(ReadAhead, CanBeDroppedInTheMiddle) {
  ReadAhead source(std::make_unique<ListSource>(1000, true, true), 2);
  EXPECT_TRUE(source.Next());
}

// Five frames at once, with a reading each, and no more until Stop().
class LiveSource : public FrameSource {
 public:
  static constexpr int kFrames = 5;
  LiveSource() { info_.live = true; }
  const SourceInfo& Info() const override { return info_; }
  std::optional<SourceFrame> Next() override {
    if (next_ == kFrames) {
      given_.set_value();
      stopped_.get_future().wait();
      return std::nullopt;
    }
    SourceFrame frame;
    frame.number = next_++;
    frame.imu.push_back({0.1 * next_, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    return frame;
  }
  void Stop() override { stopped_.set_value(); }
  std::future<void> given() { return given_.get_future(); }

 private:
  SourceInfo info_;
  int next_ = 0;
  std::promise<void> given_, stopped_;
};

TEST(ReadAhead, KeepsTheNewestFrameOfALiveSourceWithAllReadings) {
  auto live = std::make_unique<LiveSource>();
  const std::future<void> given = live->given();
  ReadAhead source(std::move(live));
  given.wait();
  EXPECT_TRUE(source.Wait(0));
  const auto frame = source.Next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->number, LiveSource::kFrames - 1);
  ASSERT_EQ(frame->imu.size(), 5u);
  for (size_t i = 0; i < 5; ++i) EXPECT_DOUBLE_EQ(frame->imu[i].time, 0.1 * (1 + i));
  EXPECT_EQ(source.replaced(), LiveSource::kFrames - 1);
  EXPECT_FALSE(source.Wait(0.01));
}  // ends by Stop()

}  // namespace
}  // namespace alidade::wrappers_test
