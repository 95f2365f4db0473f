// The motion between keyframes stays that between neighbors in time when keyframes are culled.
#include "alidade/map/keyframe_motion.h"

#include <gtest/gtest.h>

#include <memory>

#include "alidade/map/adjust_motion.h"
#include "alidade/map/map_store.h"
#include "problems/synthetic_map.h"

namespace alidade::keyframe_motion_test {
namespace {

Preintegration Steps(double seconds) {
  Preintegration motion;
  for (int i = 0; i < 10; ++i) motion.Append(seconds / 10, {0.1, 0.2, -0.3}, {1, 9, 2}, {});
  return motion;
}

class KeyFrameMotions : public testing::Test {
 protected:
  void SetUp() override {
    world_ = MakeSyntheticWorld({.points = 100, .cameras = 5, .depth = true});
    made_ = FillMap(world_, {}, store_);
    store_.Commit([&](MapCommit& commit) {
      commit.SetWorld({MapId{0}, true, 0.01, {0, 1, 0}, 0.002});
      for (size_t i = 1; i < made_.keyframes.size(); ++i) {
        auto motion = std::make_shared<KeyFrameMotion>();
        motion->since = made_.keyframes[i - 1];
        motion->motion = Steps(0.1 * static_cast<double>(i));
        motion->gyro_bias_sigma = 1e-3;
        motion->accel_bias_sigma = 0.05;
        motion->accel_walk = 1e-3;
        motion->noise_factor = 2;
        commit.Edit(made_.keyframes[i])->motion = std::move(motion);
      }
    });
  }
  const KeyFrame& At(const MapSnapshot& map, size_t i) { return *map.Find(made_.keyframes[i]); }

  SyntheticWorld world_;
  MapStore store_;
  SyntheticMap made_;
};

TEST_F(KeyFrameMotions, AreJoinedWhereAKeyFrameIsCulled) {
  const MapSnapshot before = store_.Snapshot();
  const MapSnapshot map =
      store_.Commit([&](MapCommit& commit) { commit.Remove(made_.keyframes[2]); });
  ASSERT_TRUE(At(map, 3).motion);
  EXPECT_EQ(At(map, 3).motion->since, made_.keyframes[1]);
  const Preintegration both = At(before, 2).motion->motion.Then(At(before, 3).motion->motion);
  EXPECT_DOUBLE_EQ(At(map, 3).motion->motion.seconds, 0.5);
  EXPECT_EQ(At(map, 3).motion->motion.dp, both.dp);
  EXPECT_EQ(At(map, 4).motion, At(before, 4).motion);
}

TEST_F(KeyFrameMotions, EndsWhereTheOneBeforeIsUnknown) {
  const MapSnapshot map = store_.Commit([&](MapCommit& commit) {
    commit.Edit(made_.keyframes[2])->motion.reset();
    commit.Remove(made_.keyframes[2]);
  });
  EXPECT_FALSE(At(map, 3).motion);
  EXPECT_TRUE(At(map, 4).motion);
}

TEST_F(KeyFrameMotions, AreMeasurementsBetweenKeyFramesThatAreAdjusted) {
  const MapSnapshot map = store_.Snapshot();
  const auto& k = made_.keyframes;
  const BundleMotion all = MotionBetween(map, k, true, false);
  EXPECT_EQ(all.links.size(), k.size() - 1);
  EXPECT_EQ(all.states.size(), k.size());
  EXPECT_NEAR(all.gravity.y(), 9.81, 1e-12);
  // A chain of two and one of three; each has one prior of its bias.
  const BundleMotion some = MotionBetween(map, {k[0], k[1], k[3], k[4]}, true, false);
  ASSERT_EQ(some.links.size(), 2u);
  EXPECT_EQ(some.states.size(), 4u);
  int priors = 0;
  for (const BundleMotionState& state : some.states) priors += state.accel_bias_sigma > 0;
  EXPECT_EQ(priors, 2);
  // The weights follow the measured noise of the pixels.
  BundleMotion half = MotionBetween(map, k, true, false);
  WeighBy(0.5, half);
  EXPECT_LT((half.links[0].covariance - 4 * all.links[0].covariance).norm(),
            1e-12 * all.links[0].covariance.norm());
  EXPECT_EQ(half.states[0].accel_bias_sigma, 2 * all.states[0].accel_bias_sigma);
  // What is not known of a scale that is held makes motions less precise, but not rotations.
  const BundleMotion held = MotionBetween(map, k, true, true);
  const Matrix9d more = held.links[0].covariance - all.links[0].covariance;
  EXPECT_EQ((more.topLeftCorner<3, 3>().norm()), 0);
  EXPECT_GT(more.diagonal().tail<6>().minCoeff(), 0);
}

TEST_F(KeyFrameMotions, AreOfNoUseWithoutMetersOrGravity) {
  MapSnapshot map = store_.Commit([&](MapCommit& commit) {
    commit.SetWorld({MapId{0}, false, 0.01, {0, 1, 0}, 0.002});
  });
  EXPECT_TRUE(MotionBetween(map, made_.keyframes, false, false).links.empty());
  EXPECT_FALSE(MotionBetween(map, made_.keyframes, true, false).links.empty());
  map = store_.Commit([&](MapCommit& commit) { commit.ForgetWorld(MapId{0}); });
  EXPECT_TRUE(MotionBetween(map, made_.keyframes, true, false).links.empty());
}

}  // namespace
}  // namespace alidade::keyframe_motion_test
