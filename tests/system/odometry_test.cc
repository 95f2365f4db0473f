// TrackResult::T_last_camera: how far the camera moved since the last frame with a pose.
#include <gtest/gtest.h>

#include "support/room_with_depth.h"

namespace alidade::odometry_test {
namespace {

class Odometry : public RoomWithDepth {};

TEST_P(Odometry, FollowsTheTruthStepByStep) {
  EXPECT_FALSE(Track(0).T_last_camera);
  double worst = 0;
  for (int number = 2; number <= 60; number += 2) {
    const TrackResult result = Track(number);
    ASSERT_EQ(result.state, TrackState::kTracking);
    ASSERT_TRUE(result.T_last_camera);
    const Se3 truth = SmallRoom().Pose(number - 2).Inverse() * SmallRoom().Pose(number);
    worst = std::max(worst, (result.T_last_camera->t - truth.t).norm());
  }
  EXPECT_LT(worst, 0.012);  // meters
}

TEST_P(Odometry, AFrameWithoutAPoseIsSteppedOver) {
  for (int number = 0; number <= 20; number += 2) Track(number);
  const cv::Mat black(SmallRoom().camera().height, SmallRoom().camera().width, CV_8UC1,
                      cv::Scalar(0));
  EXPECT_FALSE(TrackNext(black, {}).T_last_camera);
  const TrackResult found = Track(22);
  ASSERT_EQ(found.state, TrackState::kTracking);
  if (found.T_last_camera) {
    const Se3 truth = SmallRoom().Pose(20).Inverse() * SmallRoom().Pose(22);
    EXPECT_LT((found.T_last_camera->t - truth.t).norm(), 0.03);
  }
}

TEST_P(Odometry, ANewRecordingDoesNotContinueTheLast) {
  for (int number = 0; number <= 20; number += 2) Track(number);
  slam_.Reset();
  const TrackResult found = Track(16);
  ASSERT_EQ(found.state, TrackState::kTracking);
  EXPECT_FALSE(found.T_last_camera);
}

INSTANTIATE_TEST_SUITE_P(Schedules, Odometry, testing::Bool(), ScheduleName);

}  // namespace
}  // namespace alidade::odometry_test
