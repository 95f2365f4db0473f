// Depth at its limits: stereo pairs outdoors, depth cameras with nothing in range.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "alidade/slam.h"
#include "support/motorway.h"

namespace alidade::stereo_test {
namespace {

SlamSettings StereoSettings() {
  SlamSettings settings;
  settings.sensor = Sensor::kStereo;
  return settings;
}

// The speed is not known at first, and distant trees also fit a stationary camera.
TEST(StereoOutdoors, TheFirstMotionIsTheTrueOne) {
  for (const double step : {1.0, 2.0}) {  // meters: 36 and 72 km/h at 10 frames per second
    const Motorway motorway = DriveMotorway({.step = step, .frames = 8});
    Slam slam(motorway.camera, StereoSettings());
    Se3 last;
    for (size_t i = 0; i < motorway.frames.size(); ++i) {
      const Motorway::Pair& pair = motorway.frames[i];
      const TrackResult result = slam.Track({pair.time, pair.left, pair.right, {}});
      ASSERT_EQ(result.state, TrackState::kTracking) << i << ": " << result.reason();
      if (i > 0) {
        const double moved = (last.Inverse() * result.T_world_camera).t.norm();
        EXPECT_NEAR(moved, step, 0.1) << "frame " << i << " at " << step << " m per frame";
      }
      last = result.T_world_camera;
    }
  }
}

// All depths are beyond the sensor's range: no map starts, however many keypoints there are.
TEST(Start, WithoutALandmarkIsNoStart) {
  const Motorway motorway = DriveMotorway({.frames = 2});
  Camera camera = motorway.camera;
  camera.baseline = 0;
  camera.depth_factor = 1000;
  SlamSettings settings = StereoSettings();
  settings.sensor = Sensor::kRgbd;
  {
    Slam slam(camera, settings);
    for (const Motorway::Pair& pair : motorway.frames) {
      const cv::Mat far(camera.height, camera.width, CV_16UC1, cv::Scalar(12000));  // 12 m
      const TrackResult result = slam.Track({pair.time, pair.left, {}, far});
      EXPECT_EQ(result.state, TrackState::kInitializing);
      EXPECT_EQ(result.matches, 0);
      EXPECT_EQ(std::string(result.reason()), "too few corners with depth in the sensor's range");
    }
    EXPECT_EQ(slam.Snapshot().keyframe_count(), 0);
  }
  {
    settings.tracker.depth_range = 20;  // as for a sensor of longer range
    Slam slam(camera, settings);
    const cv::Mat far(camera.height, camera.width, CV_16UC1, cv::Scalar(12000));
    const TrackResult result = slam.Track({0, motorway.frames[0].left, {}, far});
    EXPECT_EQ(result.state, TrackState::kTracking) << result.reason();
    EXPECT_GT(result.matches, 200);
    EXPECT_EQ(slam.Snapshot().landmark_count(), result.matches);
  }
}

TEST(Start, APairThatSeesOnlyWhatIsTooFarForItSaysSo) {
  const Motorway motorway = DriveMotorway({.frames = 1});
  SlamSettings settings = StereoSettings();
  settings.mapper.max_depth_error = 0.008;  // as if the baseline were ten times shorter
  Slam slam(motorway.camera, settings);
  const TrackResult result = slam.Track({0, motorway.frames[0].left, motorway.frames[0].right, {}});
  EXPECT_EQ(result.state, TrackState::kInitializing);
  EXPECT_EQ(std::string(result.reason()), "too few corners near enough for accurate depth");
}

}  // namespace
}  // namespace alidade::stereo_test
