#include "alidade/map/map_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "alidade/map/anchor.h"
#include "problems/synthetic_map.h"
#include "support/check_map.h"

namespace alidade::map_store_test {
namespace {

// A keyframe with `keypoints` keypoints and no landmarks.
KeyFrame BareKeyFrame(int keypoints, KeyFrameId parent = {}, const Se3& T_camera_world = {}) {
  auto frame = std::make_shared<Frame>();
  frame->keypoints.resize(keypoints);
  frame->descriptors.resize(keypoints);
  KeyFrame keyframe;
  keyframe.frame = std::move(frame);
  keyframe.parent = parent;
  keyframe.T_camera_world = T_camera_world;
  return keyframe;
}

Landmark SeenBy(std::vector<Observation> observations) {
  Landmark landmark;
  landmark.p_world = {0, 0, 3};
  landmark.reference = landmark.born = observations.front().keyframe;
  landmark.observations = std::move(observations);
  return landmark;
}

double Distance(const Se3& a, const Se3& b) { return (a * b.Inverse()).Log().norm(); }

Se3 Sideways(double x) { return {Eigen::Matrix3d::Identity(), {x, 0, 0}}; }

class MapStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    store_.Commit([&](MapCommit& commit) {
      a_ = commit.Add(BareKeyFrame(4));
      b_ = commit.Add(BareKeyFrame(4, a_, Sideways(-1)));
      both_ = commit.Add(SeenBy({{a_, 0}, {b_, 1}}));
      in_b_ = commit.Add(SeenBy({{b_, 2}}));
    });
  }
  MapStore store_;
  KeyFrameId a_, b_;
  LandmarkId both_, in_b_;
};

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

TEST_F(MapStoreTest, CulledKeyframesGoWhenNobodyIsPlacedAgainstThem) {
  KeyFrameId c;
  store_.Commit([&](MapCommit& commit) { c = commit.Add(BareKeyFrame(1, b_, Sideways(-2))); });
  const MapSnapshot before = store_.Commit([&](MapCommit& commit) { commit.Remove(c); });
  const Anchor anchor = AnchorTo(before.state(), c, Sideways(-2.5));
  const Anchor kept = Reanchored(before.state(), anchor);
  EXPECT_EQ(kept.keyframe, b_);
  store_.ReleaseCulledKeyFrames(before.version());
  const MapSnapshot after = store_.Commit([&](MapCommit& commit) { commit.Remove(b_); });
  EXPECT_FALSE(after.MapOf(c).valid());
  EXPECT_TRUE(after.MapOf(b_).valid());  // culled after the release
  EXPECT_NEAR(PoseOf(after.state(), kept).t.x(), -2.5, 1e-12);
  EXPECT_EQ(after.state().culled.size(), 1);
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

TEST_F(MapStoreTest, AKeyframeWithoutAParentBeginsAMap) {
  KeyFrameId root, child;
  store_.Commit([&](MapCommit& commit) {
    root = commit.Add(BareKeyFrame(1));
    KeyFrame keyframe = BareKeyFrame(2);
    keyframe.parent = root;
    child = commit.Add(std::move(keyframe));
  });
  const MapSnapshot map = store_.Snapshot();
  EXPECT_NE(map.MapOf(root), map.MapOf(a_));
  EXPECT_EQ(map.MapOf(child), map.MapOf(root));
  EXPECT_EQ(map.Maps().size(), 2u);
  EXPECT_THAT(map.KeyFramesOf(map.MapOf(root)), testing::ElementsAre(root, child));
  store_.Commit([&](MapCommit& commit) { commit.Remove(map.MapOf(root)); });
  EXPECT_EQ(store_.Snapshot().Maps().size(), 1u);
  EXPECT_NE(store_.Snapshot().Find(in_b_), nullptr);
  ExpectConsistent(store_.Snapshot());
}

TEST_F(MapStoreTest, AnAnchorFollowsPlaceAndScaleOfItsKeyframeEvenAfterCulling) {
  KeyFrameId c;
  store_.Commit([&](MapCommit& commit) {
    KeyFrame keyframe = BareKeyFrame(2);
    keyframe.parent = b_;
    keyframe.T_camera_world.t = {0, 0, 3};
    c = commit.Add(std::move(keyframe));
  });
  const Se3 T_frame_c{ExpSo3({0.1, 0.2, 0}), {0.5, 0, 0}};
  const MapSnapshot before = store_.Snapshot();
  const Anchor anchor = AnchorTo(before.state(), c, T_frame_c * before.PoseOf(c));
  const Se3 T_c_b = before.PoseOf(c) * before.PoseOf(b_).Inverse();
  store_.Commit([&](MapCommit& commit) { commit.Remove(c); });
  EXPECT_LT(Distance(PoseOf(store_.Snapshot().state(), anchor), T_frame_c * before.PoseOf(c)),
            1e-12);
  store_.Commit([&](MapCommit& commit) {  // a loop closure doubles all lengths around b
    KeyFrame* b = commit.Edit(b_);
    b->T_camera_world = Se3{ExpSo3({0, 0.3, 0}), {1, 2, 3}};
    b->scale *= 2;
  });
  const MapSnapshot after = store_.Snapshot();
  Se3 frame = T_frame_c, c_in_b = T_c_b;
  frame.t *= 2;
  c_in_b.t *= 2;
  EXPECT_DOUBLE_EQ(after.ScaleOf(c), 2);
  EXPECT_LT(Distance(PoseOf(after.state(), anchor), frame * c_in_b * after.PoseOf(b_)), 1e-12);
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

TEST_F(MapStoreTest, RemovingAKeyframeHandsItsChildrenToItsParent) {
  KeyFrameId c, d;
  store_.Commit([&](MapCommit& commit) {
    c = commit.Add(BareKeyFrame(1, b_, Sideways(-2)));
    d = commit.Add(BareKeyFrame(1, c, Sideways(-3)));
    commit.Remove(b_);
    if (commit.Find(in_b_))
      commit.RefreshLandmark(in_b_);  // as every caller does: it may have no observations now
    commit.RefreshLandmark(both_);
  });
  const MapSnapshot map = store_.Snapshot();
  EXPECT_EQ(map.Find(c)->parent, a_);
  EXPECT_EQ(map.Find(d)->parent, c);
  EXPECT_EQ(map.Find(in_b_), nullptr);
  ExpectConsistent(map);
}

TEST_F(MapStoreTest, TheFirstKeyframeStays) {
  store_.Commit([&](MapCommit& commit) { commit.Remove(a_); });
  EXPECT_NE(store_.Snapshot().Find(a_), nullptr);
}

TEST_F(MapStoreTest, AChildOfAKeyframeRemovedMeanwhileGetsItsNextLivingAncestor) {
  // The parent was chosen from an older snapshot and removed by the mapper before the keyframe
  // arrived.
  KeyFrameId c, d;
  store_.Commit([&](MapCommit& commit) { c = commit.Add(BareKeyFrame(1, b_, Sideways(-2))); });
  store_.Commit([&](MapCommit& commit) { commit.Remove(b_); });
  store_.Commit([&](MapCommit& commit) { d = commit.Add(BareKeyFrame(1, b_, Sideways(-3))); });
  EXPECT_EQ(store_.Snapshot().Find(d)->parent, a_);
  store_.Commit([&](MapCommit& commit) { commit.Remove(d); });
  EXPECT_NEAR(store_.Snapshot().PoseOf(d).t.x(), -3, 1e-12);
}

TEST_F(MapStoreTest, ThePoseOfACulledKeyframeFollowsItsParents) {
  KeyFrameId c;
  const Se3 T_c = Se3::Exp((Vector6d() << 0.3, -2, 1, 0.2, -0.1, 0.4).finished());
  store_.Commit([&](MapCommit& commit) { c = commit.Add(BareKeyFrame(1, b_, T_c)); });
  const Se3 T_c_a = T_c * store_.Snapshot().PoseOf(a_).Inverse();
  store_.Commit([&](MapCommit& commit) { commit.Remove(c); });
  EXPECT_LT(Distance(store_.Snapshot().PoseOf(c), T_c), 1e-12);
  store_.Commit([&](MapCommit& commit) { commit.Remove(b_); });  // now two levels up
  EXPECT_LT(Distance(store_.Snapshot().PoseOf(c), T_c), 1e-12);
  const Se3 moved = Se3::Exp((Vector6d() << 1, 2, 3, -0.3, 0.2, 0.1).finished());
  store_.Commit([&](MapCommit& commit) { commit.Edit(a_)->T_camera_world = moved; });
  EXPECT_LT(Distance(store_.Snapshot().PoseOf(c), T_c_a * moved), 1e-12);
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
