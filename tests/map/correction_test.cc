// Large corrections: everything relative to a keyframe must follow in position and scale.
#include "alidade/map/correction.h"

#include <gtest/gtest.h>

#include "alidade/map/anchor.h"
#include "problems/drifted_map.h"
#include "support/check_map.h"

namespace alidade::correction_test {
namespace {

const Sim3 kMove{1.4, ExpSo3({0.3, -0.5, 0.2}), {2, -1, 0.5}};

void ExpectNear(const Se3& a, const Se3& b, double bound = 1e-9) {
  EXPECT_LT(RotationAngle(a, b), bound);
  EXPECT_LT((a.t - b.t).norm(), bound);
}

// A map of eight keyframes in a row, three of them culled, with one anchor per keyframe.
struct Fixture {
  SyntheticWorld world = MakeSyntheticWorld({.points = 300, .cameras = 8});
  MapStore store;
  std::vector<KeyFrameId> ids;
  std::vector<Anchor> anchors;
  std::vector<Se3> frames;  // T_camera_world of the anchors

  Fixture() {
    ids = FillDriftedMap(world, {}, store).keyframes;
    store.Commit([&](MapCommit& commit) {
      for (KeyFrameId id : {ids[3], ids[6], ids[2]}) {  // includes a parent culled after its child
        const std::vector<LandmarkId> landmarks = commit.Find(id)->landmarks;
        commit.Remove(id);
        for (LandmarkId landmark : landmarks) {
          if (landmark.valid()) commit.RefreshLandmark(landmark);
        }
      }
    });
    const MapSnapshot map = store.Snapshot();
    ExpectConsistent(map);
    for (KeyFrameId id : ids) {
      frames.push_back(Se3::Exp((Vector6d() << 0.1, 0.2, -0.1, 0.1, -0.05, 0.2).finished()) *
                       map.PoseOf(id));
      anchors.push_back(AnchorTo(map.state(), id, frames.back()));
    }
  }
};

TEST(CommitCorrections, WhatIsYoungerFollowsItsParentsWithItsScale) {
  Fixture fixture;
  const MapSnapshot before = fixture.store.Snapshot();
  // Computed when only the first five keyframes existed.
  std::vector<KeyFrameCorrection> corrections;
  for (KeyFrameId id : before.KeyFrames()) {
    if (id > fixture.ids[4]) break;
    corrections.push_back({id, InOtherWorld(before.PoseOf(id), kMove), kMove.s});
  }
  const MapSnapshot after =
      fixture.store.Commit([&](MapCommit& commit) { CommitCorrections(commit, corrections); });
  ExpectConsistent(after);
  EXPECT_EQ(after.corrections(), before.corrections() + 1);
  for (size_t i = 0; i < fixture.ids.size(); ++i) {
    SCOPED_TRACE(i);
    ExpectNear(after.PoseOf(fixture.ids[i]),
               InOtherWorld(before.PoseOf(fixture.ids[i]), kMove));  // also the culled ones
    EXPECT_NEAR(after.ScaleOf(fixture.ids[i]), kMove.s, 1e-12);
    ExpectNear(PoseOf(after.state(), fixture.anchors[i]), InOtherWorld(fixture.frames[i], kMove));
  }
  EXPECT_GT(after.landmark_count(), 100);
  for (LandmarkId id : after.Landmarks()) {
    const Landmark &was = *before.Find(id), &is = *after.Find(id);
    EXPECT_LT((is.p_world - kMove * was.p_world).norm(), 1e-9);
    EXPECT_LT((is.normal - kMove.R.cast<float>() * was.normal).norm(), 1e-5);
    EXPECT_NEAR(is.min_distance, kMove.s * was.min_distance, 1e-4);
    EXPECT_NEAR(is.max_distance, kMove.s * was.max_distance, 1e-4);
  }
}

TEST(CommitCorrections, LandmarksKeepTheirPixelInTheirReferenceWhereEachKeyFrameMovesByItself) {
  Fixture fixture;
  const MapSnapshot before = fixture.store.Snapshot();
  std::vector<KeyFrameCorrection> corrections;
  for (KeyFrameId id : before.KeyFrames()) {
    const double i = id.value;
    const Sim3 move{1 + 0.05 * i, ExpSo3({0.01 * i, 0.02 * i, 0}), {0.1 * i, 0, -0.1 * i}};
    corrections.push_back({id, InOtherWorld(before.PoseOf(id), move), move.s});
  }
  const MapSnapshot after =
      fixture.store.Commit([&](MapCommit& commit) { CommitCorrections(commit, corrections); });
  for (LandmarkId id : after.Landmarks()) {
    const Landmark &was = *before.Find(id), &is = *after.Find(id);
    const double growth = 1 + 0.05 * was.reference.value;
    const Eigen::Vector3d p_before = before.PoseOf(was.reference) * was.p_world;
    const Eigen::Vector3d p_after = after.PoseOf(is.reference) * is.p_world;
    EXPECT_LT((p_after - growth * p_before).norm(), 1e-9);
  }
}

TEST(CommitCorrections, ScalesOfSeveralAddUp) {
  Fixture fixture;
  const Anchor anchor = fixture.anchors[6];  // relative to a culled keyframe
  Se3 expected = fixture.frames[6];
  for (int round = 0; round < 3; ++round) {
    const MapSnapshot map = fixture.store.Snapshot();
    std::vector<KeyFrameCorrection> corrections;
    for (KeyFrameId id : map.KeyFrames())
      corrections.push_back({id, InOtherWorld(map.PoseOf(id), kMove), kMove.s});
    fixture.store.Commit([&](MapCommit& commit) { CommitCorrections(commit, corrections); });
    expected = InOtherWorld(expected, kMove);
  }
  ExpectNear(PoseOf(fixture.store.Snapshot().state(), anchor), expected, 1e-8);
}

TEST(CommitCorrections, OtherMapsStayWhereTheyAre) {
  Fixture fixture;
  const std::vector<KeyFrameId> others = FillDriftedMap(fixture.world, {}, fixture.store).keyframes;
  const MapSnapshot before = fixture.store.Snapshot();
  const KeyFrameId root = fixture.ids[0];
  const MapSnapshot after = fixture.store.Commit([&](MapCommit& commit) {
    CommitCorrections(commit, {{root, InOtherWorld(before.PoseOf(root), kMove), kMove.s}});
  });
  ExpectConsistent(after);
  for (KeyFrameId id : others) ExpectNear(after.PoseOf(id), before.PoseOf(id), 1e-15);
  for (LandmarkId id : after.Landmarks()) {
    if (after.MapOf(after.Find(id)->reference) != MapId{1}) continue;
    EXPECT_EQ(after.Find(id)->p_world, before.Find(id)->p_world);
  }
  ExpectNear(after.PoseOf(fixture.ids[7]), InOtherWorld(before.PoseOf(fixture.ids[7]), kMove));
}

TEST(CommitMerge, PutsTwoMapsIntoOneWorld) {
  Fixture fixture;  // the older map
  const Sim3 T_younger_world{0.7, ExpSo3({0.1, 0.8, -0.2}), {-3, 1, 4}};
  const std::vector<KeyFrameId> younger =
      FillDriftedMap(fixture.world, {.first = 2, .T_map_world = T_younger_world}, fixture.store)
          .keyframes;
  fixture.store.Commit([&](MapCommit& commit) { commit.Remove(younger[3]); });
  const MapSnapshot before = fixture.store.Snapshot();
  ASSERT_EQ(before.Maps().size(), 2u);
  const Se3 frame = Se3::Exp((Vector6d() << 0.3, 0, 0.1, 0, 0.1, 0).finished());
  std::vector<Anchor> anchors;
  for (KeyFrameId id : younger)
    anchors.push_back(AnchorTo(before.state(), id, frame * before.PoseOf(id)));

  const MapSnapshot after = fixture.store.Commit([&](MapCommit& commit) {
    CommitMerge(commit, MapId{1}, MapId{0}, T_younger_world.Inverse(), fixture.ids[5]);
  });
  ExpectConsistent(after);
  EXPECT_EQ(after.Maps(), std::vector<MapId>{MapId{0}});
  EXPECT_EQ(after.Find(younger[0])->parent, fixture.ids[5]);
  EXPECT_EQ(after.corrections(), before.corrections() + 1);
  for (size_t i = 0; i < younger.size(); ++i) {
    SCOPED_TRACE(i);
    ExpectNear(after.PoseOf(younger[i]), fixture.world.views[2 + i].T_camera_world);
    EXPECT_EQ(after.MapOf(younger[i]), MapId{0});
    Se3 step = frame;
    step.t /= T_younger_world.s;
    ExpectNear(PoseOf(after.state(), anchors[i]), step * fixture.world.views[2 + i].T_camera_world);
  }
  for (KeyFrameId id : fixture.ids) ExpectNear(after.PoseOf(id), before.PoseOf(id), 1e-15);
  for (LandmarkId id : after.Landmarks()) {  // both maps contain the same points, without error
    const Landmark& landmark = *after.Find(id);
    const Observation& seen = landmark.observations[0];
    const int view = after.Find(seen.keyframe)->frame->number;
    const int point = fixture.world.views[view].points[seen.keypoint];
    EXPECT_LT((landmark.p_world - fixture.world.points[point]).norm(), 1e-9);
  }
}

KeyFrameId AddEmpty(MapStore& store, KeyFrameId parent) {
  KeyFrameId id;
  store.Commit([&](MapCommit& commit) {
    KeyFrame keyframe;
    keyframe.frame = std::make_shared<Frame>();
    keyframe.parent = parent;
    id = commit.Add(std::move(keyframe));
  });
  return id;
}

TEST(CommitMerge, ParentsAreOlderThanTheirChildrenWhereverTheMapsTouch) {
  MapStore store;
  const KeyFrameId root = AddEmpty(store, {}), second = AddEmpty(store, root);
  const KeyFrameId other_root = AddEmpty(store, {});
  AddEmpty(store, other_root);
  // The older map is continued after relocalization.
  const KeyFrameId third = AddEmpty(store, second);
  const KeyFrameId fourth = AddEmpty(store, third);
  const MapSnapshot map = store.Commit([&](MapCommit& commit) {
    ASSERT_NE(commit.Find(other_root)->map, commit.Find(root)->map);
    CommitMerge(commit, commit.Find(other_root)->map, commit.Find(root)->map, Sim3{}, fourth);
  });
  ExpectConsistent(map);
  EXPECT_EQ(map.Maps().size(), 1u);
  EXPECT_EQ(map.Find(other_root)->parent, second);
}

TEST(CommitMerge, OfTwoThatWereMergedAlready) {
  MapStore store;
  std::vector<KeyFrameId> roots;
  for (int i = 0; i < 3; ++i) {
    roots.push_back(AddEmpty(store, {}));
    AddEmpty(store, roots.back());
  }
  const auto child = [&](int map) { return KeyFrameId{roots[map].value + 1}; };
  ExpectConsistent(
      store.Commit([&](MapCommit& commit) { CommitMerge(commit, {2}, {1}, kMove, child(1)); }));
  const MapSnapshot map =
      store.Commit([&](MapCommit& commit) { CommitMerge(commit, {1}, {0}, kMove, child(0)); });
  ExpectConsistent(map);
  EXPECT_EQ(map.Maps(), std::vector<MapId>{MapId{0}});
  EXPECT_NEAR(map.ScaleOf(roots[2]), kMove.s * kMove.s, 1e-12);
  ExpectNear(map.PoseOf(roots[2]), InOtherWorld(Se3{}, kMove * kMove));
}

}  // namespace
}  // namespace alidade::correction_test
