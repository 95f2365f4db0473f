// Topics of another vendor's DDS as a source of frames.
#include "alidade/io/ros/live/live_source.h"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <thread>

#include "alidade/base/error.h"
#include "alidade/run/sources/any_source.h"
#include "ros2/camera_driver.h"

namespace alidade {
namespace {

class LiveTopics : public testing::Test {
 protected:
  const int domain_ = UseOwnDomain();
};

TEST_F(LiveTopics, AreFramesWithDepthAndCalibration) {
  CameraDriver driver(domain_, FastPeer::Quality::kBestEffort, true);
  driver.Play();
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
    const SourceFrame& sent = driver.FrameAt(frame->time);
    EXPECT_EQ(cv::norm(frame->image, sent.image, cv::NORM_INF), 0);
    ASSERT_FALSE(frame->depth.empty());
    EXPECT_EQ(cv::norm(frame->depth, sent.depth, cv::NORM_INF), 0);
  }
}

TEST_F(LiveTopics, GoOnWhenTheDriverStartsAgain) {
  std::unique_ptr<FrameSource> source;
  {
    CameraDriver driver(domain_, FastPeer::Quality::kReliable, true);
    driver.Play();
    source = OpenSource("ros2:");
    ASSERT_TRUE(source->Next());
  }
  CameraDriver again(domain_, FastPeer::Quality::kReliable, true);
  constexpr size_t kLater = 10000;  // frames
  again.Play(kLater);
  std::optional<SourceFrame> frame;
  do {
    frame = source->Next();
    ASSERT_TRUE(frame);
  } while (frame->time < CameraDriver::TimeOf(kLater));
  EXPECT_EQ(cv::norm(frame->image, again.FrameAt(frame->time).image, cv::NORM_INF), 0);
}

TEST_F(LiveTopics, BringInertialReadingsOfOneTopicOrTwo) {
  for (const bool apart : {false, true}) {
    CameraDriver driver(domain_, FastPeer::Quality::kBestEffort, false);
    driver.AddImu(apart);
    driver.Play();
    const auto source = OpenSource("ros2:");
    ASSERT_TRUE(source->Info().imu);
    double last = 0, before = 0;
    int readings = 0, up_to_image = 0;
    for (int n = 0; n < 20; ++n) {
      const auto frame = source->Next();
      ASSERT_TRUE(frame);
      if (frame->imu.empty()) continue;
      for (const ImuSample& sample : frame->imu) {
        EXPECT_GT(sample.time, last);
        last = sample.time;
        EXPECT_LE((sample.angular_rate - CameraDriver::RateAt(sample.time)).norm(), 1e-6);
        EXPECT_LE((sample.specific_force - CameraDriver::ForceAt(sample.time)).norm(), 1e-6);
        if (before > 0) ++readings;
      }
      up_to_image += last >= frame->time - 1e-6;
      before = frame->time;
    }
    EXPECT_GT(readings, 90) << apart;  // 6 for each of 19 images, with some lost
    EXPECT_GT(up_to_image, 15) << apart;
  }
}

TEST_F(LiveTopics, StopEndsTheWaitForAnImage) {
  std::unique_ptr<FrameSource> source;
  {
    CameraDriver driver(domain_, FastPeer::Quality::kReliable, false);
    driver.Play();
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
