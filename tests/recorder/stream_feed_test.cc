// Who looks on costs the run nothing, not even when he fails.
#include "alidade/run/recorder/stream_feed.h"

#include <gtest/gtest.h>

#include <new>

#include "alidade/run/recorder/stream_file.h"
#include "alidade/run/run.h"
#include "alidade/stream/stream_scene.h"
#include "alidade/synth/recording.h"
#include "support/read_text.h"
#include "support/scripted_detector.h"
#include "support/temp_folder.h"

namespace alidade::stream_feed_test {
namespace {

RunOptions Short(const std::string& out) {
  RunOptions options;
  options.source = "synth:room?frames=12&width=320&height=240";
  options.out = out;
  return options;
}

struct Warnings : RunWatcher {
  void Warn(const std::string& message) override { all += message + "\n"; }
  std::string all;
};

TEST(StreamFeed, ThatFailsIsWarnedOfAndTheRunIsTheSame) {
  const TempFolder folder;
  alidade::Run(Short(folder / "alone"), {});
  StreamFeed feed("test", "");
  int taken = 0;
  feed.Join([&](const std::shared_ptr<const std::string>&) {
    if (++taken == 8) throw std::bad_alloc();
  });
  Warnings warnings;
  EXPECT_EQ(alidade::Run(Short(folder / "watched"), {&warnings, &feed}).status, 0);
  EXPECT_EQ(taken, 8);
  EXPECT_NE(warnings.all.find("the stream stopped (out of memory)"), std::string::npos)
      << warnings.all;
  for (const char* file : {"/trajectory.txt", "/map.alidade"}) {
    const std::string alone = ReadText(folder / "alone" + file);
    EXPECT_FALSE(alone.empty());
    EXPECT_EQ(alone, ReadText(folder / "watched" + file)) << file;
  }
  // What was told until then can be read.
  StreamFileReader reader(folder / "watched/run.stream");
  int kept = 0;
  while (reader.Next()) ++kept;
  EXPECT_GE(kept, 7);
}

// The n-th answer is a box n pixels from the left.
TEST(StreamFeed, TellsWhatTheDetectorFoundAndHowLongAgo) {
  constexpr int kFrames = 30;
  constexpr double kInterval = 0.1;  // seconds
  SynthSettings small;
  small.width = 320;
  small.height = 240;
  const SynthRecording room(small);
  RunSetup setup;
  SlamSettings& settings = setup.settings.slam;
  settings.ApplyProfile("phone");
  settings.sensor = Sensor::kRgbd;
  settings.dynamics.mode = DynamicsMode::kFull;
  settings.dynamics.detector_every_frames = 6;
  settings.dynamics.detector_latency_frames = 4;
  int answers = 0;
  const auto detector = std::make_shared<ScriptedDetector>([&](const cv::Mat&) {
    const auto x = static_cast<float>(++answers);
    return std::vector<Detection>{{2, 0.5f, {x, 2, 30, 40}}, {99, 0.25f, {x, 50, 9, 9}}};
  });
  Slam slam(room.camera(), settings, detector);
  EXPECT_FALSE(slam.Detections());
  const TempFolder folder;
  StreamFeed feed("test", "");  // with a file every frame is told
  std::vector<std::string> messages;
  feed.Join([&](const std::shared_ptr<const std::string>& m) { messages.push_back(*m); });
  const CameraFinding camera;
  const RunLog log;
  feed.Begin({slam, setup, camera, log, folder.path()}, folder.path());
  for (int i = 0; i < kFrames; ++i) {
    const RenderedFrame rendered = room.Render(2 * i);
    SourceFrame frame;
    frame.time = kInterval * i;
    frame.number = i;
    frame.image = rendered.image;
    feed.Frame(frame, slam.Track({frame.time, rendered.image, {}, rendered.depth}));
  }
  feed.Finished();
  feed.Written(folder.path());
  StreamScene scene;
  int told = 0;
  for (const std::string& message : messages) {
    const int before = scene.frames;
    scene.Take(message);
    if (scene.frames == before) continue;
    const int of = told++ - settings.dynamics.detector_latency_frames;
    if (of < 0) {
      EXPECT_TRUE(scene.boxes.empty());
      EXPECT_LT(scene.detection_age, 0);
      continue;
    }
    const int answered = of / 6 * 6;  // frame
    ASSERT_EQ(scene.boxes.size(), 2u) << told;
    EXPECT_EQ(scene.boxes[0].x, answered / 6 + 1);
    EXPECT_EQ(scene.boxes[0].label, "toaster");
    EXPECT_EQ(scene.boxes[1].label, "");  // a class without a name
    EXPECT_NEAR(scene.detection_age, kInterval * (told - 1 - answered), 1e-5);
  }
  EXPECT_EQ(told, kFrames);
}

}  // namespace
}  // namespace alidade::stream_feed_test
