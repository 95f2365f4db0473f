// Inertial readings of a rendered walk against its true path in map units; no images.
#include "alidade/run/calibration/inertial_windows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/run/calibration/find_imu.h"
#include "alidade/synth/recording.h"

namespace alidade::inertial_windows_test {
namespace {

constexpr double kUnit = 2.5;  // meters per map unit

struct Walk {
  SynthRecording recording;
  Trajectory trajectory;  // with the errors of a map
  std::vector<ImuSample> samples;
  Eigen::Matrix3d R_map_scene = ExpSo3({0.7, 0.2, -0.4});
};

Walk Make(const char* imu, int frames) {
  SynthSettings settings;
  settings.imu = imu;
  settings.frames = frames;
  Walk walk{SynthRecording(settings), {}, {}};
  Random random(3);
  const auto noise = [&](double sigma) -> Eigen::Vector3d {
    return sigma * Eigen::Vector3d(random.Gaussian(), random.Gaussian(), random.Gaussian());
  };
  for (int i = 0; i < frames; ++i) {
    const Se3 T = walk.recording.Pose(i);
    walk.trajectory.push_back({i / 30.0,
                               {walk.R_map_scene * T.R * ExpSo3(noise(7e-4)),
                                walk.R_map_scene * (T.t + noise(0.003)) / kUnit},
                               ""});
  }
  walk.samples = walk.recording.imu()->Between(-1, frames / 30.0 + 1);
  return walk;
}

WindowSettings Windows() {
  WindowSettings settings;
  settings.distance = 2 / kUnit;
  return settings;
}

TEST(InertialWindows, TellScaleGravityAndTheSensorOfALongWalk) {
  const Walk walk = Make("phone", 1500);  // 50 s: three windows
  const InertialFinding found = FindInertial(walk.trajectory, walk.samples, {}, Windows());
  ASSERT_EQ(found.why_not, "");
  EXPECT_EQ(found.windows, 3);
  EXPECT_EQ(found.solved, 3);
  EXPECT_NEAR(found.scale / kUnit, 1, std::max(0.01, 3 * found.scale_sigma));
  EXPECT_LT(found.scale_sigma, 0.02);
  const Eigen::Vector3d down = walk.R_map_scene * -Eigen::Vector3d::UnitZ();
  EXPECT_LT(std::acos(std::min(1.0, down.dot(found.down))), 0.005);
  const ImuModel& truth = walk.recording.imu()->truth();
  EXPECT_NEAR(found.model.time_offset, truth.time_offset, 0.002);
  EXPECT_LT(RotationAngle(found.model.T_camera_imu, truth.T_camera_imu), 0.0087);  // half a degree
  EXPECT_LT((found.model.T_camera_imu.t - truth.T_camera_imu.t).norm(),
            4 * found.translation_sigma);
  EXPECT_LT((found.bias.gyro - walk.recording.imu()->BiasAt(25).gyro).norm(), 0.003);
  EXPECT_GT(found.bias_sigma.minCoeff(), 0);

  const ImuModel known = ObservableOf(found);
  EXPECT_TRUE(known.rotation_known && known.time_offset_known);
  const std::vector<std::string> words = ImuInWords(found);
  EXPECT_THAT(words, testing::Contains(testing::ContainsRegex("rotation .* ± .* degrees")));
  EXPECT_THAT(words, testing::Contains(testing::ContainsRegex("time offset .* ± .* ms")));
  EXPECT_THAT(words, testing::Contains(testing::ContainsRegex("gyro bias .* ± .* rad/s")));
}

TEST(InertialWindows, WhatIsNoBetterThanAssumedIsNotObservable) {
  InertialFinding finding;
  finding.solved = 1;
  finding.rotation_sigma = 0.001;
  finding.translation_sigma = 0.045;
  finding.time_offset_sigma = 0.04;
  finding.model.T_camera_imu.t = {0.01, 0, 0};
  const ImuModel known = ObservableOf(finding);
  EXPECT_TRUE(known.rotation_known);
  EXPECT_FALSE(known.translation_known);
  EXPECT_FALSE(known.time_offset_known);
  EXPECT_EQ(known.T_camera_imu.t, Eigen::Vector3d::Zero());
  const std::vector<std::string> words = ImuInWords(finding);
  EXPECT_THAT(words, testing::Contains(testing::HasSubstr("time offset  not observable")));
  EXPECT_THAT(words, testing::Contains(testing::HasSubstr("lever arm    not observable")));
}

TEST(InertialWindows, ReadingsOfAnotherWalkAreRefused) {
  Walk walk = Make("ideal", 600);
  for (ImuSample& sample : walk.samples)
    sample.angular_rate = {std::sin(3 * sample.time), std::cos(2 * sample.time), 0.5};
  EXPECT_THAT(FindInertial(walk.trajectory, walk.samples, {}, Windows()).why_not,
              testing::HasSubstr("does not turn as the camera does"));
  for (ImuSample& sample : walk.samples) sample.time += 1e6;
  EXPECT_THAT(FindInertial(walk.trajectory, walk.samples, {}, Windows()).why_not,
              testing::HasSubstr("do not cover"));
}

TEST(InertialWindows, AnEvenMotionHasNoScale) {
  Walk walk = Make("phone", 600);
  const Eigen::Matrix3d R = walk.trajectory.front().T_world_camera.R;
  Random random(5);
  for (StampedPose& pose : walk.trajectory) pose.T_world_camera = {R, R.col(0) * 0.2 * pose.time};
  for (ImuSample& sample : walk.samples) {
    sample.angular_rate.setZero();
    sample.specific_force = {0, -9.81, 0};
    for (int k = 0; k < 3; ++k) {
      sample.angular_rate[k] += 0.005 * random.Gaussian();
      sample.specific_force[k] += 0.05 * random.Gaussian();
    }
  }
  ImuModel known;
  known.rotation_known = known.translation_known = known.time_offset_known = true;
  EXPECT_NE(FindInertial(walk.trajectory, walk.samples, known, Windows()).why_not, "");
}

}  // namespace
}  // namespace alidade::inertial_windows_test
