// Cameras of the network. The servers are of these tests (stream_server.h), the packets FFmpeg's.
#include <gtest/gtest.h>

#include "alidade/io/camera/camera_source.h"
#include "alidade/io/camera/stream_device.h"
#include "cameras/stream_server.h"
#include "support/expect_error.h"

namespace alidade::stream_camera_test {
namespace {

// Left border of the bright square; -1: there is none.
int SquareIn(const cv::Mat& image) {
  const auto* row = image.ptr(55);
  for (int x = 0; x < image.cols; ++x) {
    if (row[x] > 130) return x;
  }
  return -1;
}

class StreamCamera : public testing::TestWithParam<bool> {};  // RTSP or HTTP

TEST_P(StreamCamera, GivesImagesInOrderWithTheirTimes) {
  StreamServer server(GetParam());
  const auto source = OpenStreamSource(server.address(), {});
  EXPECT_TRUE(source->Info().live);
  EXPECT_EQ(source->Info().camera.width, 160);
  std::optional<SourceFrame> last;
  for (int i = 0; i < 40; ++i) {
    std::optional<SourceFrame> frame = source->Next();
    ASSERT_TRUE(frame);
    ASSERT_TRUE(frame->problem.empty()) << frame->problem;
    if (last && SquareIn(frame->image) > SquareIn(last->image)) {
      const double steps = (SquareIn(frame->image) - SquareIn(last->image)) / 4.0;
      if (GetParam())
        EXPECT_NEAR(frame->time - last->time, steps / kStreamFps, 0.3 / kStreamFps);
      else
        EXPECT_GT(frame->time, last->time);
    }
    last = std::move(frame);
  }
}

TEST_P(StreamCamera, ACutIsSurvived) {
  const WarningCatcher warnings;
  auto server = std::make_unique<StreamServer>(GetParam());
  const auto source = OpenStreamSource(server->address(), {});
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(source->Next());
  const uint16_t port = server->port();
  server = nullptr;
  std::thread back([&] {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    server = std::make_unique<StreamServer>(GetParam(), port);
  });
  double last = 0;
  for (int i = 0; i < 30; ++i) {
    const std::optional<SourceFrame> frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_GT(frame->time, last);
    last = frame->time;
  }
  back.join();
  EXPECT_GT(last, 1);  // seconds
  EXPECT_THAT(warnings.text(), testing::HasSubstr("stream is gone; waiting"));
  EXPECT_THAT(warnings.text(), testing::HasSubstr("stream is back"));
}

TEST_P(StreamCamera, StopEndsTheWaitForASilentOne) {
  StreamServer server(GetParam());
  const auto source = OpenStreamSource(server.address(), {});
  ASSERT_TRUE(source->Next());
  server.Silence();
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    source->Stop();
  });
  while (source->Next()) {
  }
  stopper.join();
}

INSTANTIATE_TEST_SUITE_P(Protocols, StreamCamera, testing::Bool(),
                         [](const auto& test) { return test.param ? "Rtsp" : "Http"; });

TEST(StreamAddress, IsShownWithoutItsPassword) {
  EXPECT_EQ(AddressToShow("rtsp://user:secret@host:8554/cam@1"), "rtsp://host:8554/cam@1");
  EXPECT_EQ(AddressToShow("rtsp://host:8554/cam@1"), "rtsp://host:8554/cam@1");
  EXPECT_EQ(AddressToShow("http://a@b"), "http://b");
  EXPECT_FALSE(IsStreamSource("rtsp:"));
  EXPECT_FALSE(IsStreamSource("recordings/http://x"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [] { OpenStreamSource("rtsp://me:secret@127.0.0.1:9/cam", {}); }),
              testing::AllOf(testing::HasSubstr("rtsp://127.0.0.1:9/cam cannot be opened"),
                             testing::Not(testing::HasSubstr("secret"))));
}

}  // namespace
}  // namespace alidade::stream_camera_test
