// The same recording gives the same bytes: with any number of threads, run after run.
#include <gtest/gtest.h>

#include "alidade/base/parallel.h"
#include "alidade/io/trajectory.h"
#include "alidade/map/map_file.h"
#include "alidade/slam.h"
#include "support/check_map.h"
#include "support/rendered_frames.h"

namespace alidade::determinism_test {
namespace {

constexpr int kFrames = 60;

struct Outcome {
  std::string trajectory, keyframes, map;  // bytes
  int tracked = 0;
  size_t inserted = 0;  // keyframes
  double worst = 0;     // largest distance to the true position, map units
};

Outcome Play(Sensor sensor, int threads, bool threaded = false, bool wait = false) {
  RenderedFrames& room = SmallRoom(320, 240);
  SetThreadCount(threads);
  SlamSettings settings;
  settings.sensor = sensor;
  settings.threaded = threaded;
  settings.wait_for_mapping = wait;
  settings.tracker.extractor.features = 600;  // for a small image
  settings.tracker.match_scale = settings.mapper.match_scale = settings.start.match_scale = 0.8;
  Slam slam(room.camera(), settings);
  Outcome outcome;
  for (int i = 0; i < kFrames; ++i) {
    const RenderedFrame& frame = room.Frame(i);
    outcome.inserted += slam.Track({frame.time, frame.image, frame.right, frame.depth}).keyframe;
  }
  slam.Finish();
  SetThreadCount(0);

  Trajectory trajectory, keyframes;
  const Se3 T_first_world = room.Pose(0).Inverse();
  for (const FramePose& pose : slam.Trajectory()) {
    if (!pose.tracked) continue;
    ++outcome.tracked;
    trajectory.push_back({pose.time, pose.T_world_camera, {}});
    const Se3 truth = T_first_world * room.Pose(pose.index);
    outcome.worst = std::max(outcome.worst, (pose.T_world_camera.t - truth.t).norm());
  }
  const MapSnapshot map = slam.Snapshot();
  for (KeyFrameId id : map.KeyFrames()) {
    keyframes.push_back({map.Find(id)->frame->time, map.Find(id)->T_camera_world.Inverse(), {}});
  }
  ExpectConsistent(map);
  outcome.trajectory = FormatTumTrajectory(trajectory);
  outcome.keyframes = FormatTumTrajectory(keyframes);
  outcome.map = slam.SaveMap();
  return outcome;
}

void ExpectSame(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.trajectory, b.trajectory);
  EXPECT_EQ(a.keyframes, b.keyframes);
  EXPECT_TRUE(a.map == b.map);
}

TEST(InlineSchedule, GivesTheSameBytesWithOneAndTwoThreadsRunAfterRun) {
  const Outcome one = Play(Sensor::kRgbd, 1);
  EXPECT_EQ(one.tracked, 60);
  ExpectSame(one, Play(Sensor::kRgbd, 2));
  ExpectSame(one, Play(Sensor::kRgbd, 2));
}

TEST(InlineSchedule, GivesTheSameBytesForOneCamera) {
  const Outcome one = Play(Sensor::kMono, 1);
  EXPECT_GT(one.tracked, 20);
  ExpectSame(one, Play(Sensor::kMono, 2));
}

TEST(InlineSchedule, ItsMapIsReadBack) {
  const Outcome run = Play(Sensor::kRgbd, 2);
  const SavedMap saved = DecodeMap(run.map);
  ExpectConsistent(saved.map);
  EXPECT_EQ(saved.sensor, "rgbd");
  EXPECT_EQ(saved.camera.width, 320);
  EXPECT_TRUE(EncodeMap(saved) == run.map);
}

TEST(ThreadedSchedule, FinishesAndTracks) {
  const Outcome run = Play(Sensor::kRgbd, 2, /*threaded=*/true);
  EXPECT_GE(run.tracked, 57);  // the mapper may lag behind
  EXPECT_LT(run.worst, 0.1);
  EXPECT_EQ(DecodeMap(run.map).sensor, "rgbd");
}

// Mapping and loop closing are done before the next frame; without a loop nothing else changes the
// map.
TEST(ThreadedSchedule, GivesTheBytesOfInlineIfItWaitsForTheMapper) {
  const Outcome waited = Play(Sensor::kRgbd, 2, /*threaded=*/true, /*wait=*/true);
  EXPECT_EQ(waited.tracked, kFrames);
  ExpectSame(waited, Play(Sensor::kRgbd, 2));
}

}  // namespace
}  // namespace alidade::determinism_test
