#include "alidade/mapping/cull.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "problems/synthetic_map.h"

namespace alidade::cull_test {
namespace {

bool Contains(const std::vector<KeyFrameId>& ids, KeyFrameId id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

// Almost stationary cameras that observe the same landmarks.
SyntheticWorld CrowdedWorld(int cameras) {
  return MakeSyntheticWorld({.points = 300, .cameras = cameras, .step = 0.005, .turn = 0});
}

TEST(FindRedundantKeyFrames, LeavesThreeViewsOfNearlyEverything) {
  const SyntheticWorld world = CrowdedWorld(9);
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const KeyFrameId newest = made.keyframes.back();
  const std::vector<KeyFrameId> redundant =
      FindRedundantKeyFrames(store.Snapshot(), newest, false, {});
  EXPECT_GE(redundant.size(), 4u);  // nine cameras at one place
  EXPECT_FALSE(Contains(redundant, newest));
  EXPECT_FALSE(Contains(redundant, made.keyframes.front()));  // defines the world frame
  const MapSnapshot after = store.Commit([&](MapCommit& commit) {
    for (KeyFrameId id : redundant) commit.Remove(id);
    for (LandmarkId id : made.landmarks) commit.RefreshLandmark(id);
  });
  int well_seen = 0;
  for (LandmarkId id : after.Landmarks()) well_seen += after.Find(id)->observations.size() >= 3;
  EXPECT_GE(well_seen, 0.9 * after.landmark_count());
}

TEST(FindRedundantKeyFrames, KeepsKeyframesThatSeeSomethingOfTheirOwn) {
  const SyntheticWorld world =
      MakeSyntheticWorld({.points = 500, .cameras = 6, .step = 1.2, .turn = 0});
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  EXPECT_TRUE(FindRedundantKeyFrames(store.Snapshot(), made.keyframes.back(), false, {}).empty());
}

TEST(FindRedundantKeyFrames, ThreeOthersAreNeeded) {
  const SyntheticWorld world = CrowdedWorld(3);  // each landmark has only two other observations
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  EXPECT_TRUE(FindRedundantKeyFrames(store.Snapshot(), made.keyframes.back(), false, {}).empty());
}

TEST(FindRedundantKeyFrames, ViewsFromFartherAwayDoNotCount) {
  // Four cameras far back and a near one, which observes the landmarks on a coarser pyramid level.
  SyntheticWorldMaker maker({.points = 500, .cameras = 1});
  for (double back : {2.0, 2.01, 2.02, 2.03})
    maker.Look({Eigen::Matrix3d::Identity(), {0, 0, back}});
  maker.Look({Eigen::Matrix3d::Identity(), {0, 0, 0}});
  maker.Look({Eigen::Matrix3d::Identity(), {0, 0, 2.04}});
  const SyntheticWorld world = maker.Take();
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const KeyFrameId near = made.keyframes[4];
  // In the near view the landmarks are larger, hence on coarser levels: the far views, on finer
  // levels, cover it.
  EXPECT_TRUE(
      Contains(FindRedundantKeyFrames(store.Snapshot(), made.keyframes.back(), false, {}), near));
  // But a far view is not covered by near ones on coarser levels.
  MapStore few;
  SyntheticWorld part = world;
  part.views = {world.views[4], world.views[4], world.views[4], world.views[0], world.views[4]};
  const SyntheticMap entered = FillMap(part, {}, few);
  EXPECT_FALSE(Contains(FindRedundantKeyFrames(few.Snapshot(), entered.keyframes.back(), false, {}),
                        entered.keyframes[3]));
}

TEST(FindRedundantKeyFrames, DoesNotJudgeKeyframesThatAreYetToBeProcessed) {
  // The tracker added two keyframes meanwhile and still holds their ids.
  const SyntheticWorld world = CrowdedWorld(9);
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const KeyFrameId processed = made.keyframes[6];
  for (KeyFrameId id : FindRedundantKeyFrames(store.Snapshot(), processed, false, {}))
    EXPECT_LT(id, processed);
}

class WeakLandmarksTest : public testing::Test {
 protected:
  void SetUp() override {
    world_ = MakeSyntheticWorld({.points = 200, .cameras = 6});
    made_ = FillMap(world_, {}, store_);
    for (LandmarkId id : made_.landmarks) {
      const Landmark* landmark = id.valid() ? store_.Snapshot().Find(id) : nullptr;
      if (landmark && landmark->observations.size() >= 3 && landmark->born == made_.keyframes[0])
        one_ = id;
    }
    ASSERT_TRUE(one_.valid());
  }
  std::vector<LandmarkId> Weak(KeyFrameId newest, bool has_depth = false) {
    still_young_.clear();
    return FindWeakLandmarks(store_.Snapshot(), {one_}, tallies_, newest, has_depth, {},
                             still_young_);
  }
  void KeepObservations(size_t count) {
    store_.Commit([&](MapCommit& commit) {
      while (commit.Find(one_)->observations.size() > count) {
        commit.RemoveObservation(one_, commit.Find(one_)->observations.back().keyframe);
      }
    });
  }
  SyntheticWorld world_;
  MapStore store_;
  SyntheticMap made_;
  LandmarkId one_;
  IdMap<LandmarkId, SightingTally> tallies_;
  std::vector<LandmarkId> still_young_;
};

TEST_F(WeakLandmarksTest, SeldomFoundIsWeak) {
  tallies_[one_] = {9, 2};
  EXPECT_EQ(Weak(made_.keyframes[0]), std::vector<LandmarkId>{one_});
  EXPECT_TRUE(still_young_.empty());
  tallies_[one_] = {8, 2};  // exactly the minimum of a quarter
  EXPECT_TRUE(Weak(made_.keyframes[0]).empty());
}

TEST_F(WeakLandmarksTest, SeenByTooFewAfterTwoKeyframesIsWeak) {
  KeepObservations(2);
  EXPECT_TRUE(Weak(made_.keyframes[1]).empty());  // too early to decide
  EXPECT_EQ(still_young_, std::vector<LandmarkId>{one_});
  EXPECT_EQ(Weak(made_.keyframes[2]), std::vector<LandmarkId>{one_});
  // With depth, two observations suffice.
  EXPECT_TRUE(Weak(made_.keyframes[2], /*has_depth=*/true).empty());
  KeepObservations(1);
  EXPECT_EQ(Weak(made_.keyframes[2], true), std::vector<LandmarkId>{one_});
}

TEST_F(WeakLandmarksTest, TheTrialEndsAfterThreeKeyframes) {
  EXPECT_TRUE(Weak(made_.keyframes[2]).empty());
  EXPECT_EQ(still_young_, std::vector<LandmarkId>{one_});
  EXPECT_TRUE(Weak(made_.keyframes[3]).empty());
  EXPECT_TRUE(still_young_.empty());
}

TEST_F(WeakLandmarksTest, OnesThatAreGoneAreForgotten) {
  store_.Commit([&](MapCommit& commit) { commit.Remove(one_); });
  EXPECT_TRUE(Weak(made_.keyframes[1]).empty());
  EXPECT_TRUE(still_young_.empty());
}

}  // namespace
}  // namespace alidade::cull_test
