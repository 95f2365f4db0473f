// Messages whose header stamps are not in the order of recording are played in order of time.
#include <gmock/gmock.h>

#include <numeric>

#include "alidade/io/files/open_source.h"
#include "bags/small_recording.h"
#include "support/expect_error.h"

namespace alidade::disorder_test {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

constexpr int kFrames = 40;

std::vector<int> Numbers() {
  std::vector<int> numbers(kFrames);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

// Frame `stamps[i]` is recorded in place i; its gray level is its number. A depth image beside
// each.
std::vector<WrittenMessage> Recorded(Dialect dialect, const std::vector<int>& stamps) {
  std::vector<WrittenMessage> messages = {
      {"/camera/camera_info", "sensor_msgs/CameraInfo", kStart, InfoMessage(dialect, kStart, {})}};
  for (int i = 0; i < kFrames; ++i) {
    const int frame = stamps[static_cast<size_t>(i)];
    messages.push_back({"/camera/image_raw", "sensor_msgs/Image", StampOf(i) + 5'000'000,
                        ImageMessage(dialect, StampOf(frame), "camera", "mono8",
                                     cv::Mat(48, 64, CV_8UC1, cv::Scalar(frame)))});
    messages.push_back({"/camera/depth_registered/image", "sensor_msgs/Image",
                        StampOf(i) + 6'000'000,
                        ImageMessage(dialect, StampOf(i), "camera", "16UC1", TinyDepth(i))});
  }
  return messages;
}

class Disorder : public testing::TestWithParam<bool> {  // true: ROS 2
 protected:
  std::unique_ptr<FrameSource> Open(const std::vector<int>& stamps) {
    const bool ros2 = GetParam();
    const auto messages = Recorded({ros2}, stamps);
    return OpenSource(ros2 ? folder_.Write("walk.mcap", McapBytes({"zstd"}, false).Of(messages))
                           : folder_.Write("walk.bag", BagBytes({"lz4"}).Of(messages)));
  }
  static std::vector<int> Played(FrameSource& source, bool with_depth = true) {
    std::vector<int> played;
    while (const auto frame = source.Next()) {
      EXPECT_EQ(frame->problem, "");
      const int number = frame->image.at<uchar>(0, 0);
      EXPECT_EQ(frame->stamp,
                "1403715" + std::to_string(273'262142976 + number * kGap).insert(3, "."));
      if (with_depth) {
        EXPECT_EQ(frame->depth.at<uint16_t>(0, 0), 1000 + number);
      }
      played.push_back(number);
    }
    return played;
  }
  TempFolder folder_;
  WarningCatcher warnings_;
};

TEST_P(Disorder, SwappedNeighborsArePlayedInOrderOfTime) {
  std::vector<int> stamps = Numbers();
  for (const size_t i : {0, 7, 9, 20, 38}) std::swap(stamps[i], stamps[i + 1]);
  const auto source = Open(stamps);
  EXPECT_THAT(Played(*source), ElementsAreArray(Numbers()));
  EXPECT_THAT(warnings_.text(), HasSubstr("not in order"));
  // The same from any frame on.
  for (int first = 0; first < kFrames; ++first) {
    ASSERT_TRUE(source->Seek(first));
    EXPECT_EQ(source->Next()->image.at<uchar>(0, 0), first);
  }
}

TEST_P(Disorder, AMessageThatComesEarlyOrLateIsPlayedInItsPlace) {
  std::vector<int> stamps = Numbers();
  std::rotate(stamps.begin() + 5, stamps.begin() + 6, stamps.begin() + 10);    // late by four
  std::rotate(stamps.begin() + 20, stamps.begin() + 23, stamps.begin() + 24);  // early by three
  const auto source = Open(stamps);
  EXPECT_THAT(Played(*source), ElementsAreArray(Numbers()));
}

TEST_P(Disorder, MessagesInOrderAreLeftAsTheyAre) {
  const auto source = Open(Numbers());
  EXPECT_THAT(Played(*source), ElementsAreArray(Numbers()));
  EXPECT_EQ(warnings_.text(), "");
}

// Far out of order is another recording, or a damaged stamp: each message is played once, and those
// around it stay where they are.
TEST_P(Disorder, NoMessageIsLostOrPlayedTwice) {
  std::vector<int> stamps = Numbers();
  std::rotate(stamps.begin(), stamps.begin() + 20, stamps.end());
  EXPECT_THAT(Played(*Open(stamps), false), ElementsAreArray(stamps));
  std::reverse(stamps.begin(), stamps.end());
  EXPECT_THAT(Played(*Open(stamps), false), testing::UnorderedElementsAreArray(stamps));
}

INSTANTIATE_TEST_SUITE_P(Ros, Disorder, testing::Bool(),
                         [](const auto& test) { return test.param ? "Two" : "One"; });

}  // namespace
}  // namespace alidade::disorder_test
