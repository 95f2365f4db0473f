// Deferred localization: frames before the start of a map of one camera, and its first frames, get
// their poses later. On a rendered room with exact poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "alidade/slam.h"
#include "alidade/synth/recording.h"
#include "support/rendered_frames.h"

namespace alidade::early_frames_test {
namespace {

constexpr int kFrames = 70;

RenderedFrames& TheRoom() { return SmallRoom(320, 240); }

SlamSettings Settings(int most) {
  SlamSettings settings;
  settings.early.max_frames = most;
  settings.early.settle_frames = 20;
  return settings;
}

std::vector<FramePose> Feed(Slam& slam, int frames) {
  for (int i = 0; i < frames; ++i)
    slam.Track({TheRoom().Frame(i).time, TheRoom().Frame(i).image, {}, {}});
  return slam.Trajectory();
}

int FirstTracked(const std::vector<FramePose>& trajectory) {
  for (const FramePose& pose : trajectory) {
    if (pose.tracked) return pose.index;
  }
  return -1;
}

TEST(EarlyFrames, ThoseBeforeTheStartGetPosesOnceTheMapHasSettled) {
  Slam without(TheRoom().camera(), Settings(0)), with(TheRoom().camera(), Settings(180));
  const int start = FirstTracked(Feed(without, kFrames));
  ASSERT_GT(start, 1);
  const std::vector<FramePose> trajectory = Feed(with, kFrames);
  EXPECT_EQ(FirstTracked(trajectory), 0);
  for (const FramePose& pose : trajectory) {
    EXPECT_TRUE(pose.tracked) << pose.index;
    EXPECT_EQ(pose.late, pose.index < start) << pose.index;
  }
}

TEST(EarlyFrames, WhatHasNotSettledIsPlacedAtTheEnd) {
  Slam slam(TheRoom().camera(), Settings(180));
  const std::vector<FramePose> before = Feed(slam, 25);
  EXPECT_GT(FirstTracked(before), 1);
  slam.Finish(60);
  EXPECT_EQ(FirstTracked(slam.Trajectory()), 0);
}

TEST(EarlyFrames, ACutForgetsThoseThatWait) {
  Slam slam(TheRoom().camera(), Settings(180));
  Feed(slam, 2);
  slam.Reset();
  const std::vector<FramePose> trajectory = Feed(slam, kFrames);
  ASSERT_EQ(trajectory.size(), 2u + kFrames);
  EXPECT_FALSE(trajectory[0].tracked || trajectory[1].tracked);
  EXPECT_TRUE(trajectory[2].tracked);
}

// While it rotates, the camera sees only the edge of the map, where the depths of all landmarks are
// wrong in the same way: the position creeps from frame to frame, then jumps.
TEST(EarlyFrames, NoneIsPlacedBeyondALeap) {
  SynthSettings settings;
  settings.path = "turn";
  settings.arm = 0.4;
  settings.frames = 160;
  settings.fps = 15;
  settings.seed = 2;
  settings.width = 480;
  settings.height = 360;
  constexpr int kFirst = 70, kLast = 125;
  const SynthRecording recording(settings);
  std::vector<RenderedFrame> frames;
  for (int i = kFirst; i < kLast; ++i) frames.push_back(recording.Render(i));
  // The longest step between consecutive frames with a pose, as a multiple of the median step.
  const auto leap = [&](double max_leap) {
    SlamSettings with = Settings(180);
    with.early.max_leap = max_leap;
    Slam slam(recording.camera(), with);
    for (const RenderedFrame& frame : frames) slam.Track({frame.time, frame.image, {}, {}});
    slam.Finish(60);
    std::vector<double> steps;
    const std::vector<FramePose> poses = slam.Trajectory();
    for (size_t i = 1; i < poses.size(); ++i) {
      if (poses[i - 1].tracked && poses[i].tracked)
        steps.push_back((poses[i].T_world_camera.t - poses[i - 1].T_world_camera.t).norm());
    }
    std::sort(steps.begin(), steps.end());
    return steps.empty() ? 0 : steps.back() / steps[steps.size() / 2];
  };
  EXPECT_GT(leap(1000), 6);
  const double held = leap(EarlyFrameSettings().max_leap);
  EXPECT_GT(held, 0);
  EXPECT_LT(held, 4.5);
}

}  // namespace
}  // namespace alidade::early_frames_test
