// Any thread may make queries while another tracks (system/slam.h, "Threads"). The tests check
// little of their results; ThreadSanitizer checks for data races (scripts/sanitize tsan).
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <thread>
#include <vector>

#include "alidade/base/timing.h"
#include "alidade/map/map_file.h"
#include "alidade/slam.h"
#include "support/check_map.h"
#include "support/rendered_frames.h"
#include "support/scripted_detector.h"

namespace alidade::threads_test {
namespace {

// One part of the room, then another without overlap, from which the camera returns to the first:
// two maps that are merged. The time between the parts is what the way between them takes: a camera
// that was elsewhere a moment ago could not be there (ReachSettings).
std::vector<RenderedFrame> TwoParts() {
  std::vector<RenderedFrame> frames;
  const auto add = [&](int first, int last, int step) {
    for (int i = first; i <= last; i += step) frames.push_back(SmallRoom().Frame(i));
  };
  add(0, 36, 3);
  add(360, 594, 6);
  return frames;
}

SlamSettings Everything() {
  SlamSettings settings;
  settings.ApplyProfile("phone");
  settings.image_width = 0;
  settings.sensor = Sensor::kRgbd;
  settings.threaded = true;
  settings.new_map_frames = 4;
  settings.semidense.enabled = true;
  settings.dynamics.mode = DynamicsMode::kFull;
  return settings;
}

// Makes all queries repeatedly, on its own thread.
class Asker {
 public:
  explicit Asker(const Slam& slam)
      : slam_(slam), thread_([this] {
          try {
            Run();
          } catch (const std::exception& error) {
            ADD_FAILURE() << error.what();
            rounds_ = 2;
          }
        }) {}
  ~Asker() {
    done_ = true;
    thread_.join();
  }
  int rounds() const { return rounds_; }

 private:
  void Run() {
    int seen = 0;  // frames
    while (!done_) {
      const Stopwatch round;
      const int before = slam_.frames();
      EXPECT_GE(before, seen);
      const std::vector<FramePose> all = slam_.Trajectory(), late = slam_.Trajectory(before / 2);
      EXPECT_GE(static_cast<int>(all.size()) + 1, before);  // one may be in progress
      for (size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].index, static_cast<int>(i));
      if (!late.empty()) {
        EXPECT_EQ(late.front().index, before / 2);
      }
      EXPECT_LE(slam_.Times().frame.size(), static_cast<size_t>(slam_.frames()));
      for (const FeatureUse& feature : slam_.Features()) {
        EXPECT_TRUE(feature.x >= 0 && feature.x < 400 && feature.y >= 0 && feature.y < 300);
        EXPECT_TRUE(feature.static_probability >= 0 && feature.static_probability <= 1);
      }
      const cv::Mat mask = slam_.MoverMask();
      if (!mask.empty()) {
        EXPECT_EQ(mask.size(), cv::Size(400, 300));
      }
      EXPECT_TRUE(slam_.Health().ok()) << slam_.Health().Stopped();
      EXPECT_GE(slam_.Counts().merges, 0);
      EXPECT_GE(slam_.SemiDense().keyframes, 0);
      EXPECT_EQ(slam_.camera().width, 400);
      EXPECT_EQ(slam_.first_number(), 0);
      const MapSnapshot map = slam_.Snapshot();
      if (rounds_ % 8 == 0) {
        ExpectConsistent(map);
        ExpectConsistent(DecodeMap(slam_.SaveMap()).map);
      }
      seen = before;
      ++rounds_;
      // Leaves time for the tracker, also where a round is slow.
      std::this_thread::sleep_for(
          std::chrono::duration<double, std::milli>(2 + 3 * round.Milliseconds()));
    }
  }

  const Slam& slam_;
  std::atomic<bool> done_{false};
  std::atomic<int> rounds_{0};
  std::thread thread_;
};

TEST(Threads, AnyMayAskEverythingWhileAnotherTracks) {
  const std::vector<RenderedFrame> frames = TwoParts();
  const auto detector = std::make_shared<ScriptedDetector>([](const cv::Mat&) {
    return std::vector<Detection>{{0, 0.9f, cv::Rect2f(20, 10, 30, 60)}};
  });
  Slam slam(SmallRoom().camera(), Everything(), detector);
  int tracked = 0;
  {
    const Asker first(slam), second(slam);
    for (size_t i = 0; i < frames.size(); ++i) {
      const RenderedFrame& frame = frames[i];
      const TrackResult result = slam.Track({frame.time, frame.image, {}, frame.depth});
      tracked += result.state == TrackState::kTracking;
      if (i % 3 == 2) slam.Finish();  // so that earlier places can be recognized
    }
    slam.Finish();
    while (first.rounds() < 2 || second.rounds() < 2) std::this_thread::yield();
  }
  EXPECT_GE(tracked, 30);
  EXPECT_GT(slam.SemiDense().keyframes, 0);
  EXPECT_GE(slam.Counts().merges, 1);
  ExpectConsistent(slam.Snapshot());
}

// The answers of one frame come from one frame, also where the camera is changed beside them.
TEST(Threads, AnyMayAskWhileTheCameraIsChanged) {
  SynthSettings synth;
  synth.scene = "desk";
  synth.width = 400;
  synth.height = 300;
  synth.speed = 2;
  RenderedFrames& desk = FramesOf(synth);
  SlamSettings settings;
  settings.ApplyProfile("phone");
  settings.image_width = 0;
  settings.readout.enabled = false;
  settings.refine.enabled = true;
  settings.dynamics.mode = DynamicsMode::kGeometry;
  Slam slam(Camera::FromFieldOfView(400, 300, 85), settings);
  {
    std::atomic<int> masks{0};
    std::atomic<bool> done{false};
    std::thread asker([&] {
      while (!done) {
        const cv::Mat mask = slam.MoverMask();
        masks += !mask.empty();
        EXPECT_TRUE(mask.empty() || mask.size() == cv::Size(400, 300));
        EXPECT_EQ(slam.camera().height, 300);
        slam.Features();
      }
    });
    for (int i = 0; i < 180 && slam.camera_changes() == 0; ++i) {
      const RenderedFrame& frame = desk.Frame(i);
      slam.Track({frame.time, frame.image, {}, {}});
    }
    done = true;
    asker.join();
    EXPECT_GT(masks, 0);
  }
  EXPECT_GT(slam.camera_changes(), 0);
}

// Driving calls from several threads run one at a time.
TEST(Threads, DrivingCallsTakeTurns) {
  const std::vector<RenderedFrame> frames = TwoParts();
  SlamSettings settings = Everything();
  settings.dynamics.mode = DynamicsMode::kOff;
  settings.semidense.enabled = false;
  Slam slam(SmallRoom().camera(), settings);
  std::atomic<bool> done{false};
  std::thread finisher([&] {
    while (!done) slam.Finish();
  });
  for (int i = 0; i < 8; ++i) {
    const RenderedFrame& frame = frames[static_cast<size_t>(i)];
    EXPECT_EQ(slam.Track({frame.time, frame.image, {}, frame.depth}).state, TrackState::kTracking);
  }
  done = true;
  finisher.join();
  EXPECT_EQ(slam.frames(), 8);
}

// A detector that throws something other than an Error: the next frames report it, in both
// schedules.
TEST(Failure, OfTheDetectorIsToldByTheFramesAndByHealth) {
  const std::vector<RenderedFrame> frames = TwoParts();
  for (bool threaded : {false, true}) {
    SlamSettings settings = Everything();
    settings.threaded = threaded;
    settings.semidense.enabled = false;
    std::atomic<bool> asked{false};
    const auto detector =
        std::make_shared<ScriptedDetector>([&](const cv::Mat&) -> std::vector<Detection> {
          asked = true;
          throw 42;
        });
    Slam slam(SmallRoom().camera(), settings, detector);
    TrackResult result;
    for (int i = 0; i < 5; ++i) {
      const RenderedFrame& frame = frames[static_cast<size_t>(i)];
      result = slam.Track({frame.time, frame.image, {}, frame.depth});
      EXPECT_EQ(result.state, TrackState::kTracking);
      while (slam.Health().ok()) std::this_thread::yield();  // until it has the frame
    }
    EXPECT_TRUE(asked);
    EXPECT_EQ(result.warning, "detector stopped: unknown exception");
    const SlamHealth health = slam.Health();
    EXPECT_FALSE(health.ok());
    for (const StageHealth& stage : health.stages) {
      EXPECT_EQ(stage.running, stage.name != "detector") << stage.name;
      EXPECT_EQ(stage.bug, stage.name == "detector") << stage.name;
    }
    slam.Finish();
    EXPECT_GT(slam.Snapshot().keyframe_count(), 0);
  }
}

}  // namespace
}  // namespace alidade::threads_test
