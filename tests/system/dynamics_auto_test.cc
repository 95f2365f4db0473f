// dynamics.mode auto: moving objects are left out once the poses follow them. Without moving
// objects the result is that of off.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/evaluation/ate.h"
#include "alidade/slam.h"
#include "alidade/synth/recording.h"
#include "support/expect_error.h"

namespace alidade::dynamics_auto_test {
namespace {

// A person with many corners walks close ahead of the camera for 3 s; with 0 actors nobody does.
SynthRecording Room(int actors, int width, uint64_t seed = 4) {
  SynthSettings settings;
  settings.frames = 200;
  settings.actors = actors;
  settings.width = width;
  settings.height = width * 3 / 4;
  settings.seed = seed;
  return SynthRecording(settings);
}

struct Played {
  int tracked = 0, with_mask = 0;  // frames
  int landmarks = 0, looks = 0;    // looks: frames that the filter processed
  double rmse = 0, path = 0;       // ATE after Sim(3) alignment; length of the true path; meters
  std::vector<std::string> stages;
  std::string poses, warnings;
};

SlamSettings Settings(DynamicsMode mode, Sensor sensor) {
  SlamSettings settings;
  settings.sensor = sensor;
  settings.dynamics.mode = mode;
  return settings;
}

Played Play(const SynthRecording& recording, const SlamSettings& settings, int frames) {
  const WarningCatcher warnings;
  Camera camera = recording.camera();
  camera.baseline = 0;
  Slam slam(camera, settings);
  Played played;
  Trajectory truth, estimate;
  for (int i = 0; i < frames; ++i) {
    const RenderedFrame frame = recording.Render(i);
    FrameInput input;
    input.time = frame.time;
    input.image = frame.image;
    if (settings.sensor == Sensor::kRgbd) input.depth = frame.depth;
    slam.Track(input);
    played.with_mask += !slam.MoverMask().empty();
    truth.push_back({frame.time, recording.Pose(i), ""});
    if (i > 0) played.path += (recording.Pose(i).t - recording.Pose(i - 1).t).norm();
  }
  slam.Finish();
  for (const FramePose& pose : slam.Trajectory()) {
    if (!pose.tracked) continue;
    ++played.tracked;
    estimate.push_back({pose.time, pose.T_world_camera, ""});
  }
  for (const StageHealth& stage : slam.Health().stages) played.stages.push_back(stage.name);
  played.rmse = EvaluateAte(truth, estimate, {.align = Alignment::kSim3}).error.rmse;
  played.poses = FormatTumTrajectory(estimate);
  played.landmarks = slam.Snapshot().landmark_count();
  played.looks = static_cast<int>(slam.Times().dynamics.size());
  played.warnings = warnings.text();
  return played;
}

TEST(DynamicsAuto, LeavesOutWhomTheCameraFollowed) {
  constexpr int kFrames = 110;
  const SynthRecording people = Room(3, 480);
  const Played off = Play(people, Settings(DynamicsMode::kOff, Sensor::kMono), kFrames);
  const Played watched = Play(people, Settings(DynamicsMode::kAuto, Sensor::kMono), kFrames);
  EXPECT_GT(off.rmse, 0.1 * off.path);  // without dynamics the people do harm
  EXPECT_LT(watched.rmse, 0.25 * off.rmse);
  EXPECT_GE(watched.tracked, 80);
  EXPECT_GT(watched.with_mask, 30);
  EXPECT_LT(watched.with_mask, kFrames);  // not from the start
  EXPECT_THAT(watched.warnings, testing::HasSubstr("moving objects are left out"));
  EXPECT_THAT(watched.stages, testing::Contains("dynamics"));
}

TEST(DynamicsAuto, IsOffWhereNothingMoves) {
  const SynthRecording empty = Room(0, 320);
  for (Sensor sensor : {Sensor::kMono, Sensor::kRgbd}) {
    const Played off = Play(empty, Settings(DynamicsMode::kOff, sensor), 70);
    const Played watched = Play(empty, Settings(DynamicsMode::kAuto, sensor), 70);
    EXPECT_EQ(watched.poses, off.poses) << NameOf(sensor);
    EXPECT_EQ(watched.landmarks, off.landmarks);
    EXPECT_GE(watched.looks, 16);
    EXPECT_LT(watched.looks, 60);
    EXPECT_EQ(off.looks, 0);
    EXPECT_EQ(watched.with_mask, 0);
    EXPECT_EQ(watched.warnings, "");
    EXPECT_EQ(watched.stages, off.stages);
  }
}

// People pass at a distance and cover at most a tenth of the image: too little for the default.
TEST(DynamicsAuto, WithDepthASmallShareOfWhatMovesIsEnoughWhenAskedFor) {
  SlamSettings settings = Settings(DynamicsMode::kAuto, Sensor::kRgbd);
  settings.dynamics.watch_moved_depth = 0.03;
  EXPECT_GT(Play(Room(3, 320), settings, 90).with_mask, 0);
  EXPECT_EQ(Play(Room(0, 320), settings, 90).with_mask, 0);
}

}  // namespace
}  // namespace alidade::dynamics_auto_test
