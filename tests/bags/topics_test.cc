// Choice of topics, association of messages, and the description of the choice.
#include <gmock/gmock.h>

#include "alidade/io/files/open_source.h"
#include "bags/small_recording.h"
#include "support/expect_error.h"

namespace alidade::topics_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr Dialect kRos2{true};

// An image of one gray level, which identifies it.
cv::Mat Grey(int level) { return {48, 64, CV_8UC1, cv::Scalar(level)}; }

WrittenMessage Picture(const std::string& topic, int64_t stamp, int level, int64_t delay = 0) {
  return {topic, "sensor_msgs/Image", stamp + delay,
          ImageMessage(kRos2, stamp, "camera", "mono8", Grey(level))};
}

WrittenMessage Info(const std::string& topic, const InfoFields& info) {
  return {topic, "sensor_msgs/CameraInfo", kStart, InfoMessage(kRos2, kStart, info)};
}

InfoFields RightInfo() {
  InfoFields info;
  info.P[3] = -60 * 0.11;
  return info;
}

class Topics : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> Open(const std::vector<WrittenMessage>& messages,
                                    const std::string& query = "",
                                    const SourceOptions& options = {}) {
    const std::string path = folder_.Write("walk.mcap", McapBytes({"lz4"}, false).Of(messages));
    return OpenSource(path + query, options);
  }
  TempFolder folder_;
  WarningCatcher warnings_;
};

std::vector<WrittenMessage> Pair() {
  std::vector<WrittenMessage> messages = {Info("/cam0/camera_info", {}),
                                          Info("/cam1/camera_info", RightInfo())};
  for (int i = 0; i < 6; ++i) {
    // The right image is stamped 1 ms later and recorded before the left one; the third is missing.
    messages.push_back(Picture("/cam0/image_raw", StampOf(i), 10 + i, 8'000'000));
    if (i != 2)
      messages.push_back(Picture("/cam1/image_raw", StampOf(i) + 1'000'000, 100 + i, -4'000'000));
  }
  return messages;
}

TEST_F(Topics, PairsBelongTogetherByTheirStamps) {
  const auto source = Open(Pair());
  EXPECT_EQ(source->Info().sensor, Sensor::kStereo);
  EXPECT_NEAR(source->Info().camera.baseline, 0.11, 1e-9);
  EXPECT_THAT(source->Info().told, HasSubstr("right /cam1/image_raw"));
  for (int i = 0; i < 6; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame && frame->problem.empty());
    EXPECT_EQ(frame->image.at<uchar>(0, 0), 10 + i);
    if (i == 2) {
      EXPECT_TRUE(frame->right.empty());
    } else {
      EXPECT_EQ(frame->right.at<uchar>(0, 0), 100 + i);
    }
  }
}

// A zero byte would end a message; line ends and escapes would break it.
TEST_F(Topics, NamesAreShownInOneLine) {
  using namespace std::string_literals;
  const std::string name = "/\0cam\n\x1b[31m"s;
  const auto source = Open({Picture(name, kStart, 1)});
  EXPECT_THAT(source->Info().told, HasSubstr("image /?cam??[31m (mono8, "));
  const std::string unknown = MessageOf(ErrorKind::kInput, [&] {
    Open({{name, "sensor_msgs/Image", kStart,
           ImageMessage(kRos2, kStart, "camera", "mono\r9", Grey(1))}});
  });
  EXPECT_THAT(unknown, HasSubstr("/?cam??[31m has the encoding `mono?9`"));
  const std::string refused =
      MessageOf(ErrorKind::kUsage, [&] { Open({Picture(name, kStart, 10)}, "?image=/cam"); });
  EXPECT_THAT(refused, HasSubstr("there are /?cam??[31m; depth"));
}

TEST_F(Topics, WhatIsFurtherApartThanAskedForIsNoPair) {
  const auto source = Open(Pair(), "?max_dt=0.0005");
  while (const auto frame = source->Next()) EXPECT_TRUE(frame->right.empty());
}

TEST_F(Topics, WithoutABaselineThereIsOneCamera) {
  auto messages = Pair();
  messages[1] = Info("/cam1/camera_info", {});
  const auto source = Open(messages);
  EXPECT_EQ(source->Info().sensor, Sensor::kMono);
  EXPECT_THAT(source->Info().told, HasSubstr("baseline"));
  EXPECT_THAT(
      MessageOf(ErrorKind::kInput, [&] { Open(messages, "", {.sensor = Sensor::kStereo}); }),
      HasSubstr("P[3]"));
  const std::string camera = folder_.Write(
      "rig.yaml",
      "model: pinhole\nwidth: 64\nheight: 48\nfx: 60\nfy: 60\ncx: 31\ncy: 24\nbaseline: 0.2\n");
  EXPECT_EQ(Open(messages, "", {.camera_file = camera})->Info().sensor, Sensor::kStereo);
}

TEST_F(Topics, TheQueryChooses) {
  const auto source = Open(Pair(), "?image=/cam1/image_raw");
  EXPECT_EQ(source->Info().sensor, Sensor::kMono);
  EXPECT_EQ(source->Info().frames, 5);
  EXPECT_EQ(source->Next()->image.at<uchar>(0, 0), 100);
  EXPECT_EQ(Open(Pair(), "?right=")->Info().sensor, Sensor::kMono);
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { Open(Pair(), "?image=/cam7/image_raw"); }),
              HasSubstr("/cam0/image_raw, /cam1/image_raw"));
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { Open(Pair(), "?picture=/cam0"); }),
              HasSubstr("`picture` is not an option"));
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { Open(Pair(), "?info=/none"); }),
              HasSubstr("CameraInfo"));
}

TEST_F(Topics, ADepthCameraBesideIsNotTakenForDepthOfThePicture) {
  std::vector<WrittenMessage> messages = {Info("/camera/color/camera_info", {})};
  for (int i = 0; i < 3; ++i) {
    messages.push_back(Picture("/camera/color/image_raw", StampOf(i), 10));
    messages.push_back({"/camera/depth/image_rect_raw", "sensor_msgs/Image", StampOf(i),
                        ImageMessage(kRos2, StampOf(i), "depth_camera", "16UC1", TinyDepth(i))});
  }
  const auto mono = Open(messages);
  EXPECT_EQ(mono->Info().sensor, Sensor::kMono);
  EXPECT_THAT(mono->Info().told, HasSubstr("not used: /camera/depth/image_rect_raw (depth)"));
  EXPECT_EQ(Open(messages, "?depth=/camera/depth/image_rect_raw")->Info().sensor, Sensor::kRgbd);
  for (WrittenMessage& message : messages) {
    if (message.topic == "/camera/depth/image_rect_raw")
      message.topic = "/camera/aligned_depth_to_color/image_raw";
  }
  EXPECT_EQ(Open(messages)->Info().sensor, Sensor::kRgbd);
}

TEST_F(Topics, WithoutStampsTheTimeOfWritingCounts) {
  std::vector<WrittenMessage> messages;
  for (int i = 0; i < 3; ++i) {
    WrittenMessage message = Picture("/cam/image", 0, 10 + i);
    message.log_time = int64_t{1'000'000'000} * (i + 5);
    messages.push_back(message);
  }
  const auto source = Open(messages);
  EXPECT_TRUE(source->Info().camera_guessed);  // no calibration
  EXPECT_EQ(source->Next()->stamp, "5.000000");
  EXPECT_EQ(source->Next()->time, 6);
  EXPECT_EQ(source->Info().camera.fps, 1);
}

TEST_F(Topics, DepthThatComesLateStillBelongsToItsPicture) {
  std::vector<WrittenMessage> messages = {Info("/camera/camera_info", {})};
  for (int i = 0; i < 40; ++i) {
    messages.push_back(Picture("/camera/image_raw", StampOf(i), i));
    messages.push_back({"/camera/depth_registered/image", "sensor_msgs/Image",
                        StampOf(i) + 1'300'000'000,
                        ImageMessage(kRos2, StampOf(i), "camera", "16UC1", TinyDepth(i))});
  }
  const auto source = Open(messages);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(source->Next()->depth.at<uint16_t>(0, 0), 1000 + i);
}

TEST_F(Topics, ACameraFileBesideIsTakenWhenNothingElseTells) {
  folder_.Write("camera.yaml",
                "model: pinhole\nwidth: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 31\ncy: 24\n");
  EXPECT_EQ(Open({Picture("/cam/image", StampOf(0), 1)})->Info().camera.fx, 50);
  EXPECT_EQ(Open(Pair())->Info().camera.fx, 60);
}

TEST_F(Topics, AnotherSizeOrEncodingCostsThatFrame) {
  std::vector<WrittenMessage> messages;
  for (int i = 0; i < 3; ++i) messages.push_back(Picture("/cam/image", StampOf(i), 1));
  messages[1].bytes =
      ImageMessage(kRos2, StampOf(1), "camera", "mono8", cv::Mat(10, 10, CV_8UC1, cv::Scalar(1)));
  messages[2].bytes = ImageMessage(kRos2, StampOf(2), "camera", "secret", Grey(1));
  const auto source = Open(messages);
  EXPECT_EQ(source->Next()->problem, "");
  EXPECT_THAT(source->Next()->problem, HasSubstr("is 10x10, but /cam/image's first is 64x48"));
  EXPECT_THAT(source->Next()->problem, HasSubstr("`secret`"));
}

}  // namespace
}  // namespace alidade::topics_test
