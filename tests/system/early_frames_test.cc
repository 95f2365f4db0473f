// Frames before one camera's start, and its first ones, get their poses later: on a rendered room,
// with exact poses.
#include <gtest/gtest.h>

#include <vector>

#include "alidade/slam.h"
#include "alidade/synth/recording.h"

namespace alidade::early_frames_test {
namespace {

constexpr int kFrames = 70;

struct Room {
  Camera camera;
  std::vector<RenderedFrame> frames;
};

const Room& TheRoom() {
  static const Room room = [] {
    SynthSettings settings;
    settings.frames = kFrames;
    settings.width = 320;
    settings.height = 240;
    const SynthRecording recording(settings);
    Room made;
    made.camera = recording.camera();
    for (int i = 0; i < kFrames; ++i) made.frames.push_back(recording.Render(i));
    return made;
  }();
  return room;
}

SlamSettings Settings(int most) {
  SlamSettings settings;
  settings.early.most = most;
  settings.early.settle = 20;
  return settings;
}

std::vector<FramePose> Feed(Slam& slam, int frames) {
  for (int i = 0; i < frames; ++i)
    slam.Track({TheRoom().frames[i].time, TheRoom().frames[i].image, {}, {}});
  return slam.Trajectory();
}

int FirstTracked(const std::vector<FramePose>& trajectory) {
  for (const FramePose& pose : trajectory) {
    if (pose.tracked) return pose.index;
  }
  return -1;
}

TEST(EarlyFrames, ThoseBeforeTheStartGetPosesOnceTheMapHasSettled) {
  Slam without(TheRoom().camera, Settings(0)), with(TheRoom().camera, Settings(180));
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
  Slam slam(TheRoom().camera, Settings(180));
  const std::vector<FramePose> before = Feed(slam, 25);
  EXPECT_GT(FirstTracked(before), 1);
  slam.Finish(60);
  EXPECT_EQ(FirstTracked(slam.Trajectory()), 0);
}

TEST(EarlyFrames, ACutForgetsThoseThatWait) {
  Slam slam(TheRoom().camera, Settings(180));
  Feed(slam, 2);
  slam.Reset();
  const std::vector<FramePose> trajectory = Feed(slam, kFrames);
  ASSERT_EQ(trajectory.size(), 2u + kFrames);
  EXPECT_FALSE(trajectory[0].tracked || trajectory[1].tracked);
  EXPECT_TRUE(trajectory[2].tracked);
}

}  // namespace
}  // namespace alidade::early_frames_test
