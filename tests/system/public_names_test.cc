// What programs see of Slam: what Finish() returns, and names of version 0.1 that are deprecated.
#include <gtest/gtest.h>

#include <vector>

#include "alidade/slam.h"
#include "support/rendered_frames.h"

namespace alidade::public_names_test {
namespace {

TEST(PublicNames, FinishReturnsTheFinishedTrajectory) {
  SlamSettings settings;
  settings.early.settle_frames = 20;
  Slam slam(SmallRoom().camera(), settings);
  EXPECT_TRUE(slam.Finish().empty());
  for (int i = 0; i < 40; ++i) {
    const RenderedFrame& frame = SmallRoom().Frame(i);
    slam.Track({frame.time, frame.image, {}, {}});
  }
  const std::vector<FramePose> finished = slam.Finish(), asked = slam.Trajectory();
  ASSERT_EQ(finished.size(), 40u);
  ASSERT_EQ(asked.size(), finished.size());
  int tracked = 0;
  for (size_t i = 0; i < finished.size(); ++i) {
    tracked += finished[i].tracked;
    EXPECT_EQ(finished[i].tracked, asked[i].tracked);
    if (finished[i].tracked) {
      EXPECT_EQ(finished[i].T_world_camera.t, asked[i].T_world_camera.t);
    }
  }
  EXPECT_GT(tracked, 20);
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
TEST(PublicNames, ThoseOfTheLastVersionMeanTheSame) {
  SlamSettings old, now;
  EXPECT_FALSE(old.localise);
  old.localise = true;
  EXPECT_TRUE(old.localize);
  const SlamSettings copy = old;
  EXPECT_TRUE(copy.localize);
  old.localise = false;
  old.FindCamera();
  now.EnableSelfCalibration();
  EXPECT_EQ(old.All(), now.All());
  EXPECT_TRUE(now.refine.enabled);
  EXPECT_FALSE(now.readout.enabled);
  SlamCounts counts;
  counts.relocalizations = 3;
  EXPECT_EQ(counts.relocalisations, 3);
}
#pragma GCC diagnostic pop

}  // namespace
}  // namespace alidade::public_names_test
