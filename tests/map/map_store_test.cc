#include "alidade/map/map_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "map/two_keyframes.h"
#include "problems/synthetic_map.h"
#include "support/check_map.h"

namespace alidade::map_store_test {
namespace {

using MapStoreTest = TwoKeyframes;

TEST_F(MapStoreTest, EntersObservationsOnBothSides) {
  const MapSnapshot map = store_.Snapshot();
  ExpectConsistent(map);
  EXPECT_EQ(map.Find(a_)->landmarks[0], both_);
  EXPECT_EQ(map.Find(b_)->landmarks[1], both_);
  EXPECT_EQ(map.keyframe_count(), 2);
  EXPECT_EQ(map.landmark_count(), 2);
}

TEST_F(MapStoreTest, SnapshotsNeverChange) {
  const MapSnapshot before = store_.Snapshot();
  store_.Commit([&](MapCommit& commit) {
    commit.Edit(both_)->p_world = {9, 9, 9};
    commit.Edit(b_)->T_camera_world = Sideways(5);
    commit.RemoveObservation(both_, b_);
    commit.Remove(in_b_);
    commit.Add(BareKeyFrame(1, b_));
    commit.Remove(b_);
  });
  EXPECT_EQ(before.Find(both_)->p_world, Eigen::Vector3d(0, 0, 3));
  EXPECT_EQ(before.Find(both_)->observations.size(), 2u);
  EXPECT_EQ(before.Find(b_)->T_camera_world.t.x(), -1);
  EXPECT_EQ(before.Find(b_)->landmarks[2], in_b_);
  EXPECT_EQ(before.keyframe_count(), 2);
  EXPECT_EQ(before.KeyFrames(), (std::vector<KeyFrameId>{a_, b_}));
  EXPECT_EQ(before.next_keyframe(), 2u);
  EXPECT_EQ(store_.Snapshot().Find(b_), nullptr);
}

TEST_F(MapStoreTest, CopiesOnlyWhatACommitTouches) {
  store_.Commit([&](MapCommit& commit) {
    for (int i = 0; i < 300; ++i) commit.Add(SeenBy({{commit.Add(BareKeyFrame(1, a_)), 0}}));
  });
  const MapSnapshot before = store_.Snapshot();
  const MapSnapshot after =
      store_.Commit([&](MapCommit& commit) { commit.Edit(both_)->p_world.x() = 1; });
  EXPECT_EQ(after.landmarks().tree().CountNodesNotIn(before.landmarks().tree()), 2);
  EXPECT_EQ(after.keyframes().tree().CountNodesNotIn(before.keyframes().tree()), 0);
}

TEST_F(MapStoreTest, ACommitSeesItsOwnChanges) {
  store_.Commit([&](MapCommit& commit) {
    const LandmarkId made = commit.Add(SeenBy({{a_, 3}}));
    EXPECT_NE(commit.Find(made), nullptr);
    commit.Remove(made);
    EXPECT_EQ(commit.Find(made), nullptr);
    EXPECT_EQ(commit.Edit(made), nullptr);
    EXPECT_FALSE(commit.Find(a_)->landmarks[3].valid());
  });
}

TEST_F(MapStoreTest, RefusesASecondObservationPerKeyframeOrKeypoint) {
  store_.Commit([&](MapCommit& commit) {
    EXPECT_FALSE(commit.AddObservation(both_, a_, 2)) << "a sees it already";
    EXPECT_FALSE(commit.AddObservation(in_b_, a_, 0)) << "the keypoint is taken";
    EXPECT_TRUE(commit.AddObservation(in_b_, a_, 1));
    EXPECT_FALSE(commit.AddObservation(LandmarkId{99}, a_, 2));
    EXPECT_FALSE(commit.AddObservation(in_b_, KeyFrameId{99}, 2));
  });
  ExpectConsistent(store_.Snapshot());
}

TEST_F(MapStoreTest, TheReferenceIsAlwaysAKeyframeThatSeesTheLandmark) {
  store_.Commit([&](MapCommit& commit) { commit.RemoveObservation(both_, a_); });
  EXPECT_EQ(store_.Snapshot().Find(both_)->reference, b_);
  ExpectConsistent(store_.Snapshot());
}

TEST_F(MapStoreTest, ForwardsTheIdsOfFusedLandmarks) {
  LandmarkId third;
  store_.Commit([&](MapCommit& commit) {
    third = commit.Add(SeenBy({{a_, 1}}));
    commit.Replace(in_b_, both_);  // b already observes both_, so that observation is dropped
    commit.Replace(both_, third);  // a already observes third; b's observation is moved
  });
  const MapSnapshot map = store_.Snapshot();
  ExpectConsistent(map);
  EXPECT_EQ(map.Current(in_b_), third);
  EXPECT_EQ(map.Current(both_), third);
  EXPECT_EQ(map.Current(third), third);
  EXPECT_EQ(map.Find(both_), nullptr);
  EXPECT_EQ(map.landmark_count(), 1);
  EXPECT_EQ(map.Find(third)->observations.size(), 2u);
  EXPECT_FALSE(map.Find(b_)->landmarks[2].valid());

  store_.Commit([&](MapCommit& commit) { commit.Remove(third); });
  EXPECT_FALSE(store_.Snapshot().Current(in_b_).valid());
  EXPECT_FALSE(store_.Snapshot().Current(LandmarkId{}).valid());
}

// The tracker may hold ids of its last snapshot, but no older ones.
TEST_F(MapStoreTest, ForwardsGoWhenNobodyHoldsTheOldIds) {
  LandmarkId third, fourth;
  store_.Commit([&](MapCommit& commit) {
    third = commit.Add(SeenBy({{a_, 1}}));
    fourth = commit.Add(SeenBy({{a_, 2}}));
  });
  store_.Commit([&](MapCommit& commit) { commit.Replace(in_b_, both_); });
  const MapSnapshot held = store_.Snapshot();
  store_.Commit([&](MapCommit& commit) { commit.Replace(third, both_); });
  store_.ReleaseLandmarkIds(held.version());
  const MapSnapshot after =
      store_.Commit([&](MapCommit& commit) { commit.Replace(both_, fourth); });
  EXPECT_EQ(held.Current(in_b_), both_);  // a snapshot never changes
  EXPECT_EQ(after.Current(both_), fourth);
  EXPECT_EQ(after.Current(third), fourth);
  EXPECT_FALSE(after.Current(in_b_).valid());
  EXPECT_EQ(after.state().forwards.size(), 2u);
}

// Hours of issued ids: the size of the map, and of a copy, depends only on live objects.
TEST_F(MapStoreTest, TheMapIsAsLargeAsWhatLivesInIt) {
  KeyFrameId last = b_;
  MapSnapshot map;
  for (int i = 0; i < 2000; ++i) {
    map = store_.Commit([&](MapCommit& commit) {
      const KeyFrameId now = commit.Add(BareKeyFrame(40, a_));
      std::vector<LandmarkId> made;
      for (int k = 0; k < 40; ++k) made.push_back(commit.Add(SeenBy({{now, k}})));
      for (int k = 0; k < 20; ++k) commit.Replace(made[2 * k], made[2 * k + 1]);
      if (last != b_) {
        const std::vector<LandmarkId> old = commit.Find(last)->landmarks;
        commit.Remove(last);
        for (LandmarkId id : old) commit.Remove(id);
      }
      last = now;
    });
    store_.ReleaseLandmarkIds(map.version());
    store_.ReleaseCulledKeyFrames(map.version());
  }
  EXPECT_EQ(map.next_landmark(), 2u + 2000 * 40);
  EXPECT_EQ(map.landmark_count(), 22);
  EXPECT_EQ(map.keyframe_count(), 3);
  EXPECT_LE(map.landmarks().tree().CountNodes(), 6);
  EXPECT_LE(map.keyframes().tree().CountNodes(), 4);
  EXPECT_LE(map.state().culled.size(), 1);
  EXPECT_LE(map.state().forwards.size(), 20u);
  ExpectConsistent(map);
}

TEST_F(MapStoreTest, ReplacingWhatIsGoneOrItselfDoesNothing) {
  store_.Commit([&](MapCommit& commit) {
    commit.Replace(both_, both_);
    commit.Replace(both_, LandmarkId{77});
    commit.Replace(LandmarkId{77}, both_);
  });
  EXPECT_EQ(store_.Snapshot().landmark_count(), 2);
  ExpectConsistent(store_.Snapshot());
}

TEST_F(MapStoreTest, IdsAreNeverGivenTwice) {
  store_.Commit([&](MapCommit& commit) { commit.Remove(in_b_); });
  store_.Commit([&](MapCommit& commit) { EXPECT_GT(commit.Add(SeenBy({{a_, 2}})), in_b_); });
  const uint32_t next = store_.Snapshot().next_keyframe();
  store_.Commit([&](MapCommit& commit) { commit.Remove(commit.Find(a_)->map); });
  EXPECT_EQ(store_.Snapshot().keyframe_count(), 0);
  EXPECT_EQ(store_.Snapshot().Find(a_), nullptr);
  store_.Commit([&](MapCommit& commit) { EXPECT_EQ(commit.Add(BareKeyFrame(1)).value, next); });
  EXPECT_EQ(store_.Snapshot().KeyFrames().size(), 1u);
}

TEST_F(MapStoreTest, ALongChangeIsDoneAnewWhenAnotherWasQuicker) {
  int runs = 0;
  store_.CommitAside([&](MapCommit& commit) {
    if (++runs == 1) store_.Commit([&](MapCommit& quick) { quick.Remove(in_b_); });
    EXPECT_EQ(commit.Find(in_b_) == nullptr, runs == 2);
    commit.AddLoop(a_, b_);
  });
  EXPECT_EQ(runs, 2);
  const MapSnapshot map = store_.Snapshot();
  EXPECT_EQ(map.Find(in_b_), nullptr);
  EXPECT_THAT(map.Find(a_)->loops, testing::ElementsAre(b_));
  EXPECT_THAT(map.Find(b_)->loops, testing::ElementsAre(a_));
}

TEST_F(MapStoreTest, RestoresAnotherMapAndGoesOnFromIt) {
  MapStore other;
  for (int i = 0; i < 5; ++i)
    other.Commit([](MapCommit&) {});  // its versions are ahead of the saved map's
  const MapSnapshot saved = store_.Snapshot();
  other.Restore(saved);
  EXPECT_GT(other.Snapshot().version(), saved.version());
  EXPECT_GT(other.Snapshot().version(), 5u);
  other.Commit([&](MapCommit& commit) {
    commit.Edit(both_)->p_world.x() = 4;
    EXPECT_EQ(commit.Add(BareKeyFrame(1, b_)).value, 2u);
  });
  EXPECT_EQ(saved.Find(both_)->p_world.x(), 0);
  EXPECT_EQ(other.Snapshot().Find(both_)->p_world.x(), 4);
}

TEST(MapStore, ReadersSeeWholeCommitsWhileAWriterWorks) {
  MapStore store;
  KeyFrameId a;
  store.Commit([&](MapCommit& commit) { a = commit.Add(BareKeyFrame(2)); });
  LandmarkId one, two;
  store.Commit([&](MapCommit& commit) {
    one = commit.Add(SeenBy({{a, 0}}));
    two = commit.Add(SeenBy({{a, 1}}));
  });
  std::atomic<bool> stop{false};
  std::thread writer([&] {
    for (int i = 1; i <= 2000; ++i) {
      store.Commit([&](MapCommit& commit) {  // always sets both to the same value
        commit.Edit(one)->p_world.x() = i;
        commit.Edit(two)->p_world.x() = i;
      });
    }
    stop = true;
  });
  int torn = 0;
  double last = 0;
  while (!stop) {
    const MapSnapshot map = store.Snapshot();
    torn += map.Find(one)->p_world.x() != map.Find(two)->p_world.x();
    EXPECT_GE(map.Find(one)->p_world.x(), last);
    last = map.Find(one)->p_world.x();
  }
  writer.join();
  EXPECT_EQ(torn, 0);
}

TEST(MapStore, StaysConsistentUnderRandomChanges) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 150, .cameras = 10});
  MapStore store;
  FillMap(world, {.known = 0.7}, store);
  ExpectConsistent(store.Snapshot());
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    store.Commit([&](MapCommit& commit) {
      const LandmarkId one{random.Below(commit.next_landmark())},
          other{random.Below(commit.next_landmark())};
      const KeyFrameId keyframe{random.Below(commit.next_keyframe())};
      std::vector<LandmarkId> touched{one, other};
      switch (random.Below(6)) {
        case 0:
          commit.Remove(one);
          break;
        case 1:
          commit.Replace(one, other);
          break;
        case 2:
          commit.RemoveObservation(one, keyframe);
          break;
        case 3: {
          const KeyFrame* there = commit.Find(keyframe);
          if (there)
            commit.AddObservation(one, keyframe,
                                  static_cast<int>(random.Below(there->landmarks.size())));
          break;
        }
        case 4:
          commit.RefreshCovisibility(keyframe);
          break;
        case 5: {
          if (round % 20 != 0 || !commit.Find(keyframe)) break;
          touched = commit.Find(keyframe)->landmarks;
          commit.Remove(keyframe);
          break;
        }
      }
      for (LandmarkId id : touched) commit.RefreshLandmark(id);
    });
    ExpectConsistent(store.Snapshot());
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_LT(store.Snapshot().keyframe_count(), 10);
}

}  // namespace
}  // namespace alidade::map_store_test
