// Topics of another vendor's DDS as a source of frames.
#include "alidade/io/ros/live/live_source.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <thread>

#include "alidade/base/error.h"
#include "alidade/run/sources/any_source.h"
#include "ros2/fast_peer.h"
#include "ros2/messages.h"

namespace alidade {
namespace {

// A camera's driver: publishes the frames of a rendered room again and again.
class Driver {
 public:
  Driver(int domain, FastPeer::Quality quality, bool depth) : peer_(domain) {
    const auto source = OpenAnySource("synth:room?frames=20&width=320&height=240");
    camera_ = source->Info().camera;
    while (auto frame = source->Next()) frames_.push_back(std::move(*frame));
    image_ = peer_.Advertise("rt/cam/image_raw", kImageType, quality);
    info_ = peer_.Advertise("rt/cam/camera_info", kInfoType, quality);
    if (depth) depth_ = peer_.Advertise("rt/cam/depth/image_raw", kImageType, quality);
    thread_ = std::thread([this] { Play(); });
  }
  ~Driver() {
    stop_ = true;
    thread_.join();
  }
  const Camera& camera() const { return camera_; }
  const SourceFrame& Frame(size_t i) const { return frames_[i % frames_.size()]; }
  static double TimeOf(size_t i) { return 1000 + static_cast<double>(i) / 32; }
  static size_t IndexOf(double time) {
    return static_cast<size_t>(std::lround((time - 1000) * 32));
  }

 private:
  void Play() {
    for (size_t i = 0; !stop_; ++i) {
      const RosHeader header{RosTime::FromSeconds(TimeOf(i)), "cam"};
      peer_.Publish(info_, EncodeCameraInfo(header, camera_));
      peer_.Publish(image_, EncodeRawImage(TimeOf(i), "cam", Frame(i).image));
      if (depth_ >= 0) peer_.Publish(depth_, EncodeRawImage(TimeOf(i), "cam", Frame(i).depth));
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
  }

  FastPeer peer_;
  Camera camera_;
  std::vector<SourceFrame> frames_;
  int image_ = -1, info_ = -1, depth_ = -1;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

class LiveTopics : public testing::Test {
 protected:
  LiveTopics() {
    setenv("ROS_LOCALHOST_ONLY", "1", 1);
    setenv("ROS_DOMAIN_ID", std::to_string(domain_).c_str(), 1);
  }
  const int domain_ = 1 + getpid() % 200;
};

TEST_F(LiveTopics, AreFramesWithDepthAndCalibration) {
  const Driver driver(domain_, FastPeer::Quality::kBestEffort, true);
  const auto source = OpenSource("ros2:");
  const SourceInfo& info = source->Info();
  EXPECT_EQ(info.sensor, Sensor::kRgbd);
  EXPECT_TRUE(info.live);
  EXPECT_FALSE(info.camera_guessed);
  EXPECT_NEAR(info.camera.fx, driver.camera().fx, 1e-9);
  double before = 0;
  for (int n = 0; n < 10; ++n) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->problem, "");
    EXPECT_GT(frame->time, before);
    before = frame->time;
    const SourceFrame& sent = driver.Frame(Driver::IndexOf(frame->time));
    EXPECT_EQ(cv::norm(frame->image, sent.image, cv::NORM_INF), 0);
    ASSERT_FALSE(frame->depth.empty());
    EXPECT_EQ(cv::norm(frame->depth, sent.depth, cv::NORM_INF), 0);
  }
}

TEST_F(LiveTopics, StopEndsTheWaitForAnImage) {
  std::unique_ptr<FrameSource> source;
  {
    const Driver driver(domain_, FastPeer::Quality::kReliable, false);
    source = OpenSource("ros2:?image=/cam/image_raw");
    EXPECT_EQ(source->Info().sensor, Sensor::kMono);
    ASSERT_TRUE(source->Next());
  }
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    source->Stop();
  });
  while (source->Next()) {
  }
  stopper.join();
}

TEST_F(LiveTopics, ThatDoNotExistAreWaitedForUntilInterrupted) {
  SourceOptions options;
  static std::atomic<int> asked{0};
  asked = 0;
  options.interrupted = [] { return ++asked > 5; };
  EXPECT_THROW(OpenSource("ros2:", options), Error);
}

}  // namespace
}  // namespace alidade
