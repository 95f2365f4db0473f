#include "alidade/tracking/local_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "problems/synthetic_map.h"

namespace alidade::local_map_test {
namespace {

class LocalMapTest : public testing::Test {
 protected:
  void SetUp() override {
    world_ =
        MakeSyntheticWorld({.points = 900, .cameras = 14, .step = 0.8, .turn = 0});  // a long path
    made_ = FillMap(world_, {}, store_);
  }
  Se3 PoseOf(int view) const { return world_.views[view].T_camera_world; }

  SyntheticWorld world_;
  MapStore store_;
  SyntheticMap made_;
  LocalMapGatherer gatherer_;
};

TEST_F(LocalMapTest, GathersWhatKeyframesThatShareLandmarksSee) {
  const MapSnapshot map = store_.Snapshot();
  const LocalMap local =
      gatherer_.Gather(map, map.Find(made_.keyframes[6])->landmarks, PoseOf(6), 100);
  EXPECT_EQ(local.reference, made_.keyframes[6]);
  const std::set<KeyFrameId> keyframes(local.keyframes.begin(), local.keyframes.end());
  EXPECT_EQ(keyframes.size(), local.keyframes.size());  // without duplicates
  for (const Neighbour& n : map.Find(made_.keyframes[6])->covisible)
    EXPECT_EQ(keyframes.count(n.id), 1u);
  std::set<LandmarkId> expected, found;
  for (KeyFrameId id : local.keyframes) {
    for (LandmarkId landmark : map.Find(id)->landmarks) {
      if (landmark.valid()) expected.insert(landmark);
    }
  }
  for (const Landmark* landmark : local.landmarks) EXPECT_TRUE(found.insert(landmark->id).second);
  EXPECT_EQ(found, expected);
}

TEST_F(LocalMapTest, IsLimitedToTheKeyframesThatShareMost) {
  const MapSnapshot map = store_.Snapshot();
  const LocalMap local =
      gatherer_.Gather(map, map.Find(made_.keyframes[6])->landmarks, PoseOf(6), 3);
  ASSERT_EQ(local.keyframes.size(), 3u);
  EXPECT_EQ(local.keyframes[0], made_.keyframes[6]);
  const auto& covisible = map.Find(made_.keyframes[6])->covisible;
  EXPECT_EQ(local.keyframes[1], covisible[0].id);
  EXPECT_EQ(local.keyframes[2], covisible[1].id);
}

TEST_F(LocalMapTest, TakesKeyframesThatLookTheSameWayThoughTheyShareNothing) {
  // A second keyframe at the same place that observes none of the landmarks, as after turning away
  // and back.
  KeyFrameId stranger, behind;
  store_.Commit([&](MapCommit& commit) {
    KeyFrame keyframe;
    keyframe.frame = world_.views[6].frame;
    keyframe.T_camera_world = PoseOf(6);
    keyframe.parent = made_.keyframes[0];
    stranger = commit.Add(keyframe);
    keyframe.T_camera_world = Se3{ExpSo3({0, 3, 0}), {0, 0, 0}} * PoseOf(6);
    behind = commit.Add(keyframe);
  });
  const MapSnapshot map = store_.Snapshot();
  const LocalMap local =
      gatherer_.Gather(map, map.Find(made_.keyframes[6])->landmarks, PoseOf(6), 100);
  EXPECT_EQ(std::count(local.keyframes.begin(), local.keyframes.end(), stranger), 1);
  EXPECT_EQ(std::count(local.keyframes.begin(), local.keyframes.end(), behind), 0);
}

TEST_F(LocalMapTest, PassesOverIdsThatAreGone) {
  const std::vector<LandmarkId> matches = store_.Snapshot().Find(made_.keyframes[0])->landmarks;
  store_.Commit([&](MapCommit& commit) {
    for (size_t i = 0; i < matches.size(); i += 2) commit.Remove(matches[i]);
    commit.Remove(made_.keyframes[1]);
    for (LandmarkId id : made_.landmarks) commit.RefreshLandmark(id);
  });
  const LocalMap local = gatherer_.Gather(store_.Snapshot(), matches, PoseOf(0), 100);
  EXPECT_EQ(local.reference, made_.keyframes[0]);
  EXPECT_EQ(std::count(local.keyframes.begin(), local.keyframes.end(), made_.keyframes[1]), 0);
  EXPECT_FALSE(local.landmarks.empty());
}

TEST_F(LocalMapTest, OfNothingIsNothing) {
  const std::vector<LandmarkId> none(50);
  const LocalMap local = gatherer_.Gather(store_.Snapshot(), none, PoseOf(0), 100);
  EXPECT_TRUE(local.keyframes.empty());
  EXPECT_TRUE(local.landmarks.empty());
  EXPECT_FALSE(local.reference.valid());
}

TEST_F(LocalMapTest, DoesNotRememberTheCallBefore) {
  const MapSnapshot map = store_.Snapshot();
  const LocalMap first =
      gatherer_.Gather(map, map.Find(made_.keyframes[0])->landmarks, PoseOf(0), 100);
  gatherer_.Gather(map, map.Find(made_.keyframes[12])->landmarks, PoseOf(12), 100);
  const LocalMap again =
      gatherer_.Gather(map, map.Find(made_.keyframes[0])->landmarks, PoseOf(0), 100);
  EXPECT_EQ(first.keyframes, again.keyframes);
  EXPECT_EQ(first.landmarks, again.landmarks);
}

}  // namespace
}  // namespace alidade::local_map_test
