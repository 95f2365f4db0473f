// The orientation of a camera with an inertial sensor before there is a map, and after.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "alidade/slam.h"
#include "alidade/synth/recording.h"

namespace alidade::orientation_test {
namespace {

constexpr double kDegree = 0.0174533;

SynthSettings Turning(const std::string& imu, const std::string& path, int frames) {
  SynthSettings settings;
  settings.width = 400;
  settings.height = 300;
  settings.path = path;
  settings.imu = imu;
  settings.imu_rate = 200;
  settings.frames = frames;
  return settings;
}

struct Told {
  TrackResult result;
  double tilt = 0, heading = 0;  // absolute errors, radians
  double step = 0;               // error of the rotation since the frame before, radians
};

// `given`: with the readings.
std::vector<Told> Frames(const SynthSettings& settings, bool given) {
  const SynthRecording recording(settings);
  SlamSettings of_phone;
  of_phone.ApplyProfile("phone");
  Slam slam(recording.camera(), of_phone);
  if (given) slam.SetImu(recording.imu()->told());
  const Eigen::Vector3d ahead = recording.Pose(0).R.col(2);
  const Eigen::Matrix3d R_start =
      ExpSo3({0, 0, -std::atan2(ahead.y(), ahead.x())});  // heading 0 in the first frame
  std::vector<Told> all;
  double last = -1;
  for (int i = 0; i < recording.frames(); ++i) {
    FrameInput frame;
    frame.time = recording.Time(i);
    frame.image = recording.Render(i).image;
    if (given) frame.imu = recording.imu()->Between(last, frame.time);
    last = frame.time;
    Told told{slam.Track(frame)};
    if (told.result.orientation) {
      const Eigen::Matrix3d R = told.result.orientation->R_world_camera;
      const Eigen::Vector3d error = LogSo3(R_start * recording.Pose(i).R * R.transpose());
      told.tilt = error.head<2>().norm();
      told.heading = std::abs(error.z());
      if (!all.empty() && all.back().result.orientation) {
        const Eigen::Matrix3d turn = all.back().result.orientation->R_world_camera.transpose() * R;
        const Eigen::Matrix3d truth = recording.Pose(i - 1).R.transpose() * recording.Pose(i).R;
        told.step = LogSo3(turn.transpose() * truth).norm();
      }
    }
    all.push_back(std::move(told));
  }
  return all;
}

TEST(Orientation, IsKnownWhileTheCameraOnlyTurns) {
  const std::vector<Told> all = Frames(Turning("phone", "turn", 150), true);
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].result.state, TrackState::kInitializing) << i;
    if (i < 30) continue;  // the sensor's rotation is found from turning
    ASSERT_TRUE(all[i].result.orientation) << i;
    const auto& [R, tilt_sigma, heading_sigma] = *all[i].result.orientation;
    EXPECT_LT(all[i].heading, kDegree) << i;
    EXPECT_LT(all[i].heading, 3 * heading_sigma) << i;
    EXPECT_LT(all[i].tilt, 3 * tilt_sigma) << i;
    EXPECT_LT(all[i].step, 0.3 * kDegree) << i;
    EXPECT_NEAR((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-9);
  }
  EXPECT_LT(all.back().tilt, kDegree);
  EXPECT_LT(all.back().result.orientation->tilt_sigma, 2 * kDegree);
}

TEST(Orientation, OfAKnownSensorIsToldFromTheFirstFrameAndGoesOnWhenTheMapBegins) {
  const std::vector<Told> all = Frames(Turning("ideal", "turn-walk", 180), true);
  int tracked = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    ASSERT_TRUE(all[i].result.orientation) << i;
    EXPECT_LT(all[i].heading, kDegree) << i;
    EXPECT_LT(all[i].tilt, kDegree) << i;
    EXPECT_LT(all[i].step, 0.3 * kDegree) << i;  // no jump
    tracked += all[i].result.state == TrackState::kTracking;
  }
  EXPECT_GT(tracked, 20);
  EXPECT_LT(tracked, 70);  // it turns for 4 s
}

TEST(Orientation, IsNotToldWithoutASensor) {
  for (const Told& told : Frames(Turning("ideal", "turn", 5), false))
    EXPECT_FALSE(told.result.orientation);
}

}  // namespace
}  // namespace alidade::orientation_test
