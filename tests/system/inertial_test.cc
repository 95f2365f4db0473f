// A rendered room with the simulated inertial sensor of a phone, of which nothing is known.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "alidade/evaluation/ate.h"
#include "alidade/slam.h"
#include "alidade/synth/recording.h"

namespace alidade::inertial_test {
namespace {

SynthSettings Room(int frames) {
  SynthSettings settings;
  settings.width = 400;
  settings.height = 300;
  settings.imu = "phone";
  settings.imu_rate = 200;
  settings.frames = frames;
  return settings;
}

// Frames whose image is black.
struct Dark {
  int from = 0, to = 0;
};

struct Ran {
  std::vector<FramePose> trajectory;
  std::vector<TrackResult> live;
  InertialReport report;
  std::string map;      // as saved
  int keyframes = 0;    // at the end
  int with_motion = 0;  // of them, with the motion since the one before
};

// `spoil` changes the readings; null: they are not given at all.
template <typename Spoil>
Ran Travel(const SynthRecording& recording, Spoil&& spoil, bool give, const Dark& dark = {}) {
  SlamSettings settings;
  settings.ApplyProfile("phone");
  Slam slam(recording.camera(), settings);
  Ran run;
  double last = -1;
  for (int i = 0; i < recording.frames(); ++i) {
    const RenderedFrame rendered = recording.Render(i);
    FrameInput frame;
    frame.time = rendered.time;
    frame.image = i >= dark.from && i < dark.to ? cv::Mat::zeros(rendered.image.size(), CV_8U)
                                                : rendered.image;
    if (give) frame.imu = spoil(recording.imu()->Between(last, rendered.time));
    last = rendered.time;
    run.live.push_back(slam.Track(frame));
  }
  run.trajectory = slam.Finish();
  run.report = slam.Inertial();
  run.map = slam.SaveMap();
  slam.Snapshot().keyframes().ForEach([&](const KeyFrame& keyframe) {
    ++run.keyframes;
    run.with_motion += keyframe.motion != nullptr;
  });
  return run;
}

// In the dark the pose is known by dead reckoning, and found by landmarks soon after.
void ExpectReckoned(const SynthRecording& recording, const Ran& run, const Dark& dark) {
  const Se3 last = run.live[dark.from - 1].T_world_camera;
  for (int i = dark.from; i < dark.to; ++i) {
    const TrackResult& result = run.live[i];
    EXPECT_EQ(result.state, TrackState::kLost) << i;
    ASSERT_TRUE(result.predicted) << i;
    const Eigen::Vector3d moved = (last.Inverse() * *result.predicted).t;
    const Eigen::Vector3d truth = (recording.Pose(dark.from - 1).Inverse() * recording.Pose(i)).t;
    const double sigma = std::sqrt(result.quality.covariance.topLeftCorner<3, 3>().trace());
    EXPECT_LT((moved - truth).norm(), 0.02 + 3 * sigma) << i;
    EXPECT_GT(sigma, 0) << i;
    EXPECT_LT(sigma, 0.3) << i;
  }
  EXPECT_EQ(run.live[dark.to + 5].state, TrackState::kTracking);
}

using Samples = std::vector<ImuSample>;
constexpr auto kAsTheyAre = [](Samples samples) { return samples; };

// Continues in a saved map without readings: what it knows of its world stays.
void ExpectKnownAfterLoading(const SynthRecording& recording, const Ran& run) {
  const SavedMap saved = DecodeMap(run.map);
  const MapWorld* world = saved.map.WorldOf(saved.map.Maps().front());
  ASSERT_NE(world, nullptr);
  EXPECT_TRUE(world->meters);
  EXPECT_EQ(world->scale_sigma, run.report.scale_sigma);
  EXPECT_EQ(world->down, *run.report.gravity);
  EXPECT_EQ(world->down_sigma, run.report.gravity_sigma);
  SlamSettings settings;
  settings.ApplyProfile("phone");
  Slam slam(recording.camera(), settings);
  slam.Load(saved);
  EXPECT_EQ(*slam.Snapshot().WorldOf(world->map), *world);
  EXPECT_EQ(slam.SaveMap(), run.map);
}

TEST(Inertial, MakesAMapOfOneCameraMetricAndUpright) {
  const SynthRecording recording(Room(310));
  const Dark dark{260, 296};
  const Ran run = Travel(recording, kAsTheyAre, true, dark);
  ExpectReckoned(recording, run, dark);
  ASSERT_TRUE(run.report.metric) << run.report.missing;
  EXPECT_GT(run.report.samples, 1900);
  EXPECT_TRUE(run.report.left_out.empty()) << run.report.left_out;
  // The bundle adjustment has the readings, but for the first keyframe and those in the dark.
  EXPECT_GT(run.with_motion, run.keyframes / 2);
  EXPECT_LT(run.with_motion, run.keyframes);

  // Lengths: distances between the poses and between the true ones.
  double path = 0, truth = 0;
  const FramePose* before = nullptr;
  const FramePose* first = nullptr;
  for (const FramePose& pose : run.trajectory) {
    if (!pose.tracked) continue;
    if (!first) first = &pose;
    if (before && pose.index - before->index < 15) continue;
    if (before) {
      path += (pose.T_world_camera.t - before->T_world_camera.t).norm();
      truth += (recording.Pose(pose.index).t - recording.Pose(before->index).t).norm();
    }
    before = &pose;
  }
  ASSERT_GT(truth, 1);
  EXPECT_NEAR(path / truth, 1, std::max(0.02, 3 * run.report.scale_sigma));

  ASSERT_TRUE(run.report.gravity);
  const Eigen::Matrix3d R_scene_map =
      recording.Pose(first->index).R * first->T_world_camera.R.transpose();
  const Eigen::Vector3d down = R_scene_map * *run.report.gravity;
  EXPECT_LT(std::acos(std::min(1.0, -down.z())), 0.02);  // 1 degree

  const ImuModel& sensor = recording.imu()->truth();
  EXPECT_LT(RotationAngle(run.report.model.T_camera_imu, sensor.T_camera_imu), 0.02);
  EXPECT_NEAR(run.report.model.time_offset, sensor.time_offset, 0.004);
  ExpectKnownAfterLoading(recording, run);
}

TEST(Inertial, ReadingsOfAnotherMotionAreLeftOutAndChangeNothing) {
  const SynthRecording recording(Room(120));
  const Ran without = Travel(recording, kAsTheyAre, false);
  const Ran other = Travel(
      recording,
      [](Samples samples) {
        for (ImuSample& sample : samples) {
          const double t = sample.time;
          sample.angular_rate = {std::sin(3 * t), 0.8 * std::cos(2 * t), std::sin(5 * t)};
        }
        return samples;
      },
      true);
  EXPECT_FALSE(other.report.metric);
  EXPECT_EQ(other.with_motion, 0);
  EXPECT_NE(other.report.left_out.find("contradict"), std::string::npos);
  ASSERT_EQ(other.trajectory.size(), without.trajectory.size());
  for (size_t i = 0; i < without.trajectory.size(); ++i) {
    EXPECT_EQ(other.trajectory[i].tracked, without.trajectory[i].tracked) << i;
    EXPECT_EQ(other.trajectory[i].T_world_camera.t, without.trajectory[i].T_world_camera.t) << i;
  }
}

}  // namespace
}  // namespace alidade::inertial_test
