// Topics of video: single packets of H.264 and H.265 in messages.
#include <gmock/gmock.h>

#include <opencv2/videoio.hpp>

#include "alidade/io/files/open_source.h"
#include "bags/small_recording.h"
#include "bags/video_packets.h"
#include "support/expect_error.h"

namespace alidade::video_topics_test {
namespace {

using testing::HasSubstr;

constexpr int kFrames = 25;

// A pattern that moves, so that frames refer to each other.
std::vector<cv::Mat> Images() {
  cv::Mat wide(48, 64 + 3 * kFrames, CV_8UC3);
  Random random(3);
  for (auto& pixel : cv::Mat_<cv::Vec3b>(wide)) {
    for (int channel = 0; channel < 3; ++channel)
      pixel[channel] = static_cast<uchar>(random.Below(256));
  }
  cv::GaussianBlur(wide, wide, {7, 7}, 2);
  std::vector<cv::Mat> images;
  for (int i = 0; i < kFrames; ++i) images.push_back(wide(cv::Rect(3 * i, 0, 64, 48)).clone());
  return images;
}

struct Codec {
  std::string encoder, format, ending;
};
void PrintTo(const Codec& codec, std::ostream* out) { *out << codec.format; }

class VideoTopics : public testing::TestWithParam<Codec> {
 protected:
  void SetUp() override {
    Encode(0);
    if (packets_.empty()) GTEST_SKIP() << "FFmpeg has no " << GetParam().encoder;
  }

  void Encode(int b_frames) {
    packets_ = EncodeVideo(GetParam().encoder, Images(), b_frames);
    if (packets_.empty()) return;
    ASSERT_EQ(packets_.size(), size_t{kFrames});
    std::string stream;
    for (const VideoPacket& packet : packets_) stream += packet.bytes;
    cv::VideoCapture capture(folder_.Write("stream." + GetParam().ending, stream), cv::CAP_FFMPEG);
    expected_.clear();
    for (cv::Mat image; capture.read(image);) expected_.push_back(image.clone());
    ASSERT_EQ(expected_.size(), size_t{kFrames});
  }

  std::vector<WrittenMessage> Ros(Dialect dialect) const {
    std::vector<WrittenMessage> messages;
    for (const VideoPacket& packet : packets_) {
      const int64_t stamp = StampOf(packet.frame);
      messages.push_back({"/camera/video", "foxglove_msgs/CompressedVideo", stamp,
                          VideoMessage(dialect, stamp, "camera", GetParam().format, packet.bytes)});
    }
    return messages;
  }
  std::vector<WrittenMessage> Protobuf() const {
    std::vector<WrittenMessage> messages;
    for (size_t i = 0; i < packets_.size(); ++i) {
      const int64_t stamp = StampOf(packets_[i].frame);
      messages.push_back(
          {"/camera/video", "foxglove.CompressedVideo", StampOf(static_cast<int>(i)),
           ProtobufVideoMessage(stamp, "camera", GetParam().format, packets_[i].bytes)});
    }
    return messages;
  }
  std::unique_ptr<FrameSource> OpenMcap(const std::vector<WrittenMessage>& messages) {
    return OpenSource(folder_.Write("walk.mcap", McapBytes({"zstd"}, false).Of(messages)),
                      {.fov_degrees = 60, .color = true});
  }
  void ExpectFrame(const std::optional<SourceFrame>& frame, int i) const {
    ASSERT_TRUE(frame) << i;
    ASSERT_EQ(frame->problem, "") << i;
    EXPECT_NEAR(frame->time, 1e-9 * static_cast<double>(StampOf(i)), 1e-6);
    const cv::Mat& color = expected_[static_cast<size_t>(i)];
    EXPECT_EQ(cv::norm(frame->color, color, cv::NORM_INF), 0) << i;
    cv::Mat gray;
    cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
    EXPECT_EQ(cv::norm(frame->image, gray, cv::NORM_INF), 0) << i;
  }

  TempFolder folder_;
  WarningCatcher warnings_;
  std::vector<VideoPacket> packets_;
  std::vector<cv::Mat> expected_;  // OpenCV's reading of the stream
};
INSTANTIATE_TEST_SUITE_P(Of, VideoTopics,
                         testing::Values(Codec{"libx264", "h264", "h264"},
                                         Codec{"libx265", "h265", "hevc"}),
                         [](const auto& test) { return test.param.format; });

TEST_P(VideoTopics, GiveTheFramesOfTheStreamAtTheirTimes) {
  const std::string bag = folder_.Write("walk.bag", BagBytes({"lz4"}).Of(Ros({false})));
  WriteDatabase(folder_ / "walk.db3", Ros({true}));
  const std::string protobuf = folder_.Write("walk.mcap", McapBytes({""}, false).Of(Protobuf()));
  for (const std::string& path : {bag, folder_ / "walk.db3", protobuf}) {
    const auto source = OpenSource(path, {.fov_degrees = 60, .color = true});
    EXPECT_EQ(source->Info().frames, kFrames) << path;
    EXPECT_THAT(source->Info().told, HasSubstr("/camera/video (" + GetParam().format + ", 64x48"));
    for (int i = 0; i < kFrames; ++i) ExpectFrame(source->Next(), i);
    EXPECT_FALSE(source->Next());
  }
  // Compression without loss: the stream's images are those that were encoded, but for chroma.
  const std::vector<cv::Mat> images = Images();
  for (int i = 0; i < kFrames; ++i) {
    const auto at = static_cast<size_t>(i);
    EXPECT_LT(cv::norm(images[at], expected_[at], cv::NORM_L1) / (3.0 * 64 * 48), 4) << i;
  }
}

TEST_P(VideoTopics, AreDecodedFromTheKeyframeBefore) {
  const auto source = OpenMcap(Protobuf());
  for (const int i : {17, 18, 3, 4, 24, 0, 1, 9, 10, 2}) {
    ASSERT_TRUE(source->Seek(i));
    ExpectFrame(source->Next(), i);
  }
}

TEST_P(VideoTopics, ThatBeginInTheMiddleBeginAtTheNextKeyframe) {
  auto messages = Protobuf();
  messages.erase(messages.begin(), messages.begin() + 4);
  const auto source = OpenMcap(messages);
  for (int i = 4; i < kFrames; ++i) {
    const auto frame = source->Next();
    if (i >= 10) {
      ExpectFrame(frame, i);
    } else {
      EXPECT_THAT(frame->problem, HasSubstr("comes before the first keyframe")) << i;
      EXPECT_TRUE(frame->image.empty());
    }
  }
}

TEST_P(VideoTopics, WithADamagedPacketLoseTheFramesUpToTheNextKeyframe) {
  std::string& bytes = packets_[13].bytes;
  if (GetParam().format == "h264") {
    bytes.resize(bytes.size() / 2);
  } else {  // a checksum at the end tells it
    for (size_t i = bytes.size() / 3; i < bytes.size() / 2; ++i)
      bytes[i] = static_cast<char>(bytes[i] ^ 0x55);
  }
  const auto source = OpenMcap(Protobuf());
  for (int i = 0; i < kFrames; ++i) {
    const auto frame = source->Next();
    if (i < 13 || i >= 20) {
      ExpectFrame(frame, i);
    } else if (i == 13) {
      EXPECT_THAT(frame->problem, HasSubstr("message 13 of /camera/video is damaged"));
    } else {
      EXPECT_THAT(frame->problem, HasSubstr("message 13, to which it refers, is damaged")) << i;
    }
  }
}

TEST_P(VideoTopics, WithFramesStoredInAnotherOrderAreShownInOrder) {
  Encode(2);
  EXPECT_TRUE(std::any_of(packets_.begin() + 1, packets_.end(), [](const VideoPacket& packet) {
    return packet.frame < (&packet - 1)->frame;
  }));
  const auto source = OpenMcap(Protobuf());
  for (int i = 0; i < kFrames; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->problem, "");
    EXPECT_NEAR(frame->time, 1e-9 * static_cast<double>(StampOf(i)), 1e-6);
    EXPECT_EQ(cv::norm(frame->color, expected_[static_cast<size_t>(i)], cv::NORM_INF), 0) << i;
  }
}

TEST_P(VideoTopics, MayBeCompressedImages) {
  std::vector<WrittenMessage> messages;
  for (const VideoPacket& packet : packets_) {
    const int64_t stamp = StampOf(packet.frame);
    messages.push_back(
        {"/camera/image/" + GetParam().format, "sensor_msgs/CompressedImage", stamp,
         CompressedMessage({true}, stamp, "camera", GetParam().format, packet.bytes)});
  }
  const auto source = OpenMcap(messages);
  for (int i = 0; i < kFrames; ++i) ExpectFrame(source->Next(), i);
}

TEST_P(VideoTopics, HaveTheCalibrationOfTheirFrame) {
  InfoFields info;
  info.D = {0.1, -0.05, 0.001, 0.002, 0};
  const std::string dialects[] = {"protobuf", "protobuf, numbers apart", "ros1", "cdr"};
  for (const std::string& dialect : dialects) {
    const bool ros1 = dialect == "ros1", protobuf = dialect.rfind("protobuf", 0) == 0;
    auto messages = protobuf ? Protobuf() : Ros({!ros1});
    messages.insert(
        messages.begin(),
        {"/camera/calibration",
         protobuf ? "foxglove.CameraCalibration" : "foxglove_msgs/CameraCalibration", kStart,
         protobuf ? ProtobufCalibrationMessage(kStart, info, dialect == "protobuf")
                  : CalibrationMessage({!ros1}, kStart, info)});
    const auto source =
        OpenSource(folder_.Write("walk.mcap", McapBytes({"lz4"}, ros1).Of(messages)));
    EXPECT_THAT(source->Info().told, HasSubstr("calibration /camera/calibration")) << dialect;
    EXPECT_FALSE(source->Info().camera_guessed) << dialect;
    const Camera& camera = source->Info().camera;
    EXPECT_EQ(camera.fx, 60);
    EXPECT_EQ(camera.fy, 61);
    EXPECT_EQ(camera.cx, 31);
    EXPECT_EQ(camera.cy, 24);
    EXPECT_EQ(camera.distortion, (std::array<double, 5>{0.1, -0.05, 0.001, 0.002, 0}));
  }
}

TEST(VideoTopicsOfOthers, AreRefusedWithTheFormatsThatAreRead) {
  const TempFolder folder;
  const auto refused = [&](const std::string& format, const std::string& data) {
    const std::string path = folder.Write(
        "walk.mcap", McapBytes({"none"}, false)
                         .Of({{"/camera/video", "foxglove.CompressedVideo", kStart,
                               ProtobufVideoMessage(kStart, "camera", format, data)}}));
    return MessageOf(ErrorKind::kInput, [&] { OpenSource(path); });
  };
  EXPECT_THAT(refused("vp9", "xyz"),
              HasSubstr("/camera/video is video of the format `vp9`, which is not read; read are "
                        "h264 and h265"));
  EXPECT_THAT(refused("h264", "xyz"), HasSubstr("without a keyframe"));
  EXPECT_THAT(refused("h264", std::string("\0\0\1\x65xyz", 7)), HasSubstr("damaged"));
  const std::string path = folder.Write(
      "cut.mcap", McapBytes({"none"}, false)
                      .Of({{"/camera/video", "foxglove.CompressedVideo", kStart, "\x0a\x7f"}}));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(path); }), HasSubstr("truncated"));
}

}  // namespace
}  // namespace alidade::video_topics_test
