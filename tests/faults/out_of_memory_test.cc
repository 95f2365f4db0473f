// An allocation fails somewhere in a short run: at one of many places, in every thread. Nothing
// aborts or hangs, what failed is told, the next frames are tracked, and the map is whole: it is
// saved, loaded and found one's way in.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/base/parallel.h"
#include "alidade/map/map_file.h"
#include "alidade/slam.h"
#include "alidade/synth/recording.h"
#include "faults/failing_memory.h"
#include "support/check_map.h"
#include "support/scripted_detector.h"

namespace alidade::faults_test {
namespace {

constexpr int kFrames = 16;

struct Rendered {
  Camera camera;
  std::vector<RenderedFrame> frames;
};

const Rendered& Recording() {
  static const Rendered rendered = [] {
    SynthSettings settings;
    settings.scene = "desk";
    settings.frames = 4 * kFrames;
    settings.width = 320;
    settings.height = 240;
    settings.stereo = true;
    const SynthRecording recording(settings);
    Rendered made{recording.camera(), {}};
    for (int i = 0; i < kFrames; ++i) {
      made.frames.push_back(recording.Render(2 * i));
      made.frames.back().time = 0.1 * i;
    }
    return made;
  }();
  return rendered;
}

// All that can be switched on.
SlamSettings Everything(Sensor sensor, bool threaded) {
  SlamSettings settings;
  settings.sensor = sensor;
  settings.threaded = threaded;
  settings.tracker.extractor.features = 600;  // the picture is small
  settings.tracker.match_scale = settings.mapper.match_scale = settings.start.match_scale =
      settings.loop.match_scale = 0.8;
  settings.semidense.enabled = true;
  settings.dynamics.mode = DynamicsMode::kFull;
  settings.dynamics.detector_every_frames = 3;
  settings.dynamics.detector_latency_frames = 1;
  return settings;
}

struct Outcome {
  long failed = 0;       // allocations
  long allocations = 0;  // in all that time
  std::string thrown;    // by Track(), the last; empty: nothing
  int throws = 0;        // frames
  std::string warning;   // of the last frame
  std::string stopped;   // in the end
  int tracked = 0;       // frames
  TrackState last = TrackState::kInitializing;
};

// Plays the recording with memory that runs out. What must always hold is checked here.
Outcome Play(Sensor sensor, bool threaded, long after, long failures) {
  const Rendered& recording = Recording();
  Camera camera = recording.camera;
  if (sensor != Sensor::kStereo) camera.baseline = 0;
  const auto detector = std::make_shared<ScriptedDetector>([](const cv::Mat&) {
    return std::vector<Detection>{{0, 0.9f, cv::Rect2f(10, 10, 20, 40)}};
  });
  Slam slam(camera, Everything(sensor, threaded), detector);
  Outcome outcome;
  const long allocations_before = AllocationCount();
  FailAllocations(after, failures);
  int uncounted = 0;
  for (const RenderedFrame& frame : recording.frames) {
    const int before = slam.frames();
    try {
      const TrackResult result = slam.Track({frame.time, frame.image, frame.right, frame.depth});
      outcome.tracked += result.state == TrackState::kTracking;
      outcome.last = result.state;
      outcome.warning = result.warning;
    } catch (const std::exception& error) {
      outcome.thrown = error.what();
      ++outcome.throws;
      uncounted += slam.frames() == before;
    }
  }
  try {
    slam.Finish();
  } catch (const std::bad_alloc&) {  // for the trajectory that it returns
  }
  outcome.failed = StopFailing();
  outcome.allocations = AllocationCount() - allocations_before;
  slam.Finish();  // with memory again: what could not be written down is
  outcome.stopped = slam.Health().Stopped();
  EXPECT_EQ(slam.Health().ok(), outcome.stopped.empty());

  const std::vector<FramePose> trajectory = slam.Trajectory();
  EXPECT_EQ(trajectory.size(), static_cast<size_t>(slam.frames()));
  // Every frame counts, but for those there was no memory to count.
  EXPECT_EQ(slam.frames() + uncounted, kFrames);
  if (failures == 1) {
    EXPECT_EQ(uncounted, 0);
  }
  const MapSnapshot map = slam.Snapshot();
  ExpectConsistent(map);
  const std::string bytes = slam.SaveMap();
  const SavedMap saved = DecodeMap(bytes);
  ExpectConsistent(saved.map);
  EXPECT_EQ(saved.map.keyframe_count(), map.keyframe_count());

  // What comes now is tracked as ever, and tells what has stopped.
  const RenderedFrame& frame = recording.frames.back();
  const TrackResult next = slam.Track({0.1 * kFrames, frame.image, frame.right, frame.depth});
  EXPECT_EQ(next.warning, outcome.stopped);
  slam.Finish();
  // And one's way is found in the map.
  if (map.keyframe_count() > 0) {
    SlamSettings localize = Everything(sensor, false);
    localize.dynamics.mode = DynamicsMode::kOff;
    localize.localize = true;
    Slam finder(camera, localize);
    finder.Load(saved);
    finder.Track({0, frame.image, frame.right, frame.depth});
  }
  return outcome;
}

// How many allocations a run takes when all succeed.
long Allocations(Sensor sensor, bool threaded) {
  const Outcome outcome = Play(sensor, threaded, 1L << 60, 1);
  EXPECT_EQ(outcome.failed, 0);
  EXPECT_EQ(outcome.throws, 0);
  EXPECT_EQ(outcome.stopped, "");
  EXPECT_GE(outcome.tracked, sensor == Sensor::kMono ? 1 : kFrames - 1);
  return outcome.allocations;
}

// `places` of them, spread evenly over the run; at every third 40 in a row.
void Sweep(Sensor sensor, bool threaded, int places) {
  const long all = Allocations(sensor, threaded);
  int hit = 0, told = 0, at_end = 0;
  for (int i = 0; i < places; ++i) {
    const long after = all * i / places + i * 7;
    const long failures = i % 3 == 2 ? 40 : 1;
    SCOPED_TRACE("allocation " + std::to_string(after) + ", " + std::to_string(failures) +
                 " in a row");
    const Outcome outcome = Play(sensor, threaded, after, failures);
    if (testing::Test::HasFailure()) return;
    if (outcome.failed == 0) continue;
    ++hit;
    told += outcome.throws > 0 || !outcome.stopped.empty();
    at_end += outcome.last == TrackState::kTracking;
    EXPECT_LE(outcome.throws, failures);
  }
  EXPECT_GE(hit, places / 2);  // a part that stopped early has left later ones out
  // The rest are readings of stopwatches and threads of a pool, which are done without.
  EXPECT_GE(told, hit * 9 / 10);
  if (sensor != Sensor::kMono) {
    EXPECT_GE(at_end, hit * 9 / 10);
  }
}

TEST(OutOfMemory, InlineItCostsAFrameOrAPart) { Sweep(Sensor::kRgbd, false, 20); }
TEST(OutOfMemory, ThreadedItCostsAFrameOrAPart) { Sweep(Sensor::kRgbd, true, 20); }
TEST(OutOfMemory, OfStereoToo) { Sweep(Sensor::kStereo, false, 6); }
TEST(OutOfMemory, AndOfOneCamera) { Sweep(Sensor::kMono, false, 10); }

}  // namespace
}  // namespace alidade::faults_test
