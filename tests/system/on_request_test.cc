// What a user asks of a Slam between frames: to forget its maps, and to leave them as they are.
#include <gtest/gtest.h>

#include "support/check_map.h"
#include "support/room_with_depth.h"

namespace alidade::on_request_test {
namespace {

class OnRequest : public RoomWithDepth {
 protected:
  // Every second frame from `first` on. Returns how many have a pose.
  int Play(int first, int count) {
    int tracked = 0;
    for (int i = 0; i < count; ++i) tracked += Track(first + 2 * i).state == TrackState::kTracking;
    return tracked;
  }
};

TEST_P(OnRequest, ForgettingRemovesMapsAndTheirPoses) {
  EXPECT_EQ(Play(0, 30), 30);
  slam_.Forget();
  EXPECT_EQ(slam_.Snapshot().keyframe_count(), 0u);
  EXPECT_TRUE(slam_.Snapshot().Maps().empty());
  for (const FramePose& pose : slam_.Trajectory()) EXPECT_FALSE(pose.tracked);
  slam_.Forget();
  EXPECT_EQ(Play(6, 30), 30);  // a place that was known
  slam_.Finish();
  const MapSnapshot map = slam_.Snapshot();
  ExpectConsistent(map);
  ASSERT_EQ(map.Maps().size(), 1u);
  const std::vector<FramePose> poses = slam_.Trajectory();
  ASSERT_EQ(poses.size(), 60u);
  EXPECT_FALSE(poses[29].tracked);
  EXPECT_TRUE(poses[30].T_world_camera.t.isZero(1e-3));  // the new world begins here
  const Se3 truth = SmallRoom().Pose(6).Inverse() * SmallRoom().Pose(6 + 2 * 29);
  EXPECT_LT((poses[59].T_world_camera.t - truth.t).norm(), 0.05);  // meters
}

TEST_P(OnRequest, AMapThatIsLeftAsItIsDoesNotGrow) {
  EXPECT_EQ(Play(0, 30), 30);
  slam_.SetMapping(false);
  slam_.Finish();  // the keyframes that waited are mapped
  const size_t keyframes = slam_.Snapshot().keyframe_count();
  EXPECT_GT(Play(60, 20), 10);
  EXPECT_EQ(slam_.Snapshot().keyframe_count(), keyframes);
  EXPECT_EQ(slam_.Snapshot().next_keyframe(), keyframes);
  slam_.SetMapping(true);
  EXPECT_GT(Play(60, 20), 10);
  slam_.Finish();
  EXPECT_GT(slam_.Snapshot().keyframe_count(), keyframes);
}

TEST_P(OnRequest, WithoutMappingNoMapBegins) {
  slam_.SetMapping(false);
  EXPECT_EQ(Play(0, 5), 0);
  EXPECT_EQ(slam_.Snapshot().next_keyframe(), 0u);
  slam_.SetMapping(true);
  EXPECT_EQ(Play(0, 5), 5);
}

INSTANTIATE_TEST_SUITE_P(Schedules, OnRequest, testing::Bool(), ScheduleName);

}  // namespace
}  // namespace alidade::on_request_test
