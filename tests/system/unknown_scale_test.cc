// One camera that rotates: a map of unknown scale is dropped; frames that saw known places keep
// their poses.
#include <gtest/gtest.h>

#include <vector>

#include "alidade/slam.h"
#include "alidade/synth/recording.h"

namespace alidade::unknown_scale_test {
namespace {

// The camera is 0.4 m from the axis of rotation, 15 frames per second. Keyframes are dropped one by
// one (frames 58, 66, 70), between frames that keep their poses.
TEST(UnknownScale, AFrameBetweenTwoThatStayIsNotLostWithItsKeyframe) {
  SynthSettings settings;
  settings.path = "turn";
  settings.arm = 0.4;
  settings.frames = 160;
  settings.fps = 15;
  settings.seed = 1;
  settings.width = 480;
  settings.height = 360;
  const SynthRecording recording(settings);
  Slam slam(recording.camera(), {});
  constexpr int kFrames = 76;
  for (int i = 0; i < kFrames; ++i) {
    const RenderedFrame frame = recording.Render(i);
    slam.Track({frame.time, frame.image, {}, {}});
  }
  // Each time the newest keyframe is dropped, the next frame is relocalized.
  ASSERT_GT(slam.Counts().relocalizations, 1);
  const std::vector<FramePose> poses = slam.Trajectory();
  int tracked = 0;
  for (size_t i = 1; i + 1 < poses.size(); ++i) {
    const FramePose &before = poses[i - 1], &frame = poses[i], &after = poses[i + 1];
    tracked += frame.tracked;
    if (!before.tracked || !after.tracked || before.map != after.map) continue;
    EXPECT_TRUE(frame.tracked) << i;
    EXPECT_EQ(frame.map, before.map) << i;
  }
  EXPECT_GT(tracked, 55);
}

}  // namespace
}  // namespace alidade::unknown_scale_test
