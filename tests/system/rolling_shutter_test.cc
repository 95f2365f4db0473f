// A rolling-shutter camera whose readout time is not given.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "alidade/slam.h"
#include "support/rendered_frames.h"

namespace alidade::rolling_shutter_test {
namespace {

struct Ran {
  std::vector<FramePose> trajectory;
  Camera camera;
  double sigma = 0;
  std::string map;
};

Ran RunDesk(double milliseconds, bool known, bool looked_for = true) {
  SynthSettings synth;
  synth.scene = "desk";
  synth.width = 400;
  synth.height = 300;
  synth.speed = 2;
  synth.rolling_shutter = milliseconds;
  RenderedFrames& recording = FramesOf(synth);
  Camera camera = recording.camera();
  EXPECT_TRUE(camera.readout_known);
  if (!known) {
    camera.readout = {};
    camera.readout_known = false;
  }
  SlamSettings settings;
  settings.ApplyProfile("phone");
  settings.readout.enabled = looked_for;
  Slam slam(camera, settings);
  for (int i = 0; i < 150; ++i) {
    const RenderedFrame& frame = recording.Frame(i);
    slam.Track({frame.time, frame.image, {}, {}});
  }
  slam.Finish();
  return {slam.Trajectory(), slam.camera(), slam.readout_sigma(), slam.SaveMap()};
}

TEST(RollingShutter, IsFoundWhileTheMapGrows) {
  const Ran ran = RunDesk(30, false);
  EXPECT_EQ(ran.camera.readout[0], 0);
  EXPECT_NEAR(ran.camera.readout[1], 0.030, 0.006);
  EXPECT_GT(ran.sigma, 0);
  EXPECT_LT(ran.sigma, 0.0025);
}

TEST(RollingShutter, WhatIsToldStays) {
  const Ran ran = RunDesk(30, true);
  EXPECT_EQ(ran.camera.readout, (std::array{0.0, 0.03}));
  EXPECT_EQ(ran.sigma, 0);
}

TEST(RollingShutter, OfACameraThatHasNoneNothingChanges) {
  const Ran looked = RunDesk(0, false), not_looked = RunDesk(0, false, false);
  EXPECT_EQ(looked.camera.readout, (std::array{0.0, 0.0}));
  ASSERT_EQ(looked.trajectory.size(), not_looked.trajectory.size());
  for (size_t i = 0; i < looked.trajectory.size(); ++i)
    EXPECT_EQ(looked.trajectory[i].T_world_camera.t, not_looked.trajectory[i].T_world_camera.t);
}

}  // namespace
}  // namespace alidade::rolling_shutter_test
