// Parents and maps of keyframes; what is stored relative to a keyframe when it is removed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alidade/map/anchor.h"
#include "map/two_keyframes.h"
#include "support/check_map.h"

namespace alidade::spanning_tree_test {
namespace {

using SpanningTreeTest = TwoKeyframes;

TEST_F(SpanningTreeTest, CulledKeyframesGoWhenNobodyIsPlacedAgainstThem) {
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

TEST_F(SpanningTreeTest, AKeyframeWithoutAParentBeginsAMap) {
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

TEST_F(SpanningTreeTest, AnAnchorFollowsPlaceAndScaleOfItsKeyframeEvenAfterCulling) {
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

TEST_F(SpanningTreeTest, RemovingAKeyframeHandsItsChildrenToItsParent) {
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

TEST_F(SpanningTreeTest, TheFirstKeyframeStays) {
  store_.Commit([&](MapCommit& commit) { commit.Remove(a_); });
  EXPECT_NE(store_.Snapshot().Find(a_), nullptr);
}

TEST_F(SpanningTreeTest, AChildOfAKeyframeRemovedMeanwhileGetsItsNextLivingAncestor) {
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

TEST_F(SpanningTreeTest, ThePoseOfACulledKeyframeFollowsItsParents) {
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

}  // namespace
}  // namespace alidade::spanning_tree_test
