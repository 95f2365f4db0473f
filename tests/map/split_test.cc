// Splitting a map: nothing moves, no references remain between the parts, and they can be merged
// again.
#include <gtest/gtest.h>

#include "alidade/map/correction.h"
#include "problems/drifted_map.h"
#include "support/check_map.h"

namespace alidade::split_test {
namespace {

struct Row {
  SyntheticWorld world = MakeSyntheticWorld({.points = 300, .cameras = 8});
  MapStore store;
  std::vector<KeyFrameId> ids = FillDriftedMap(world, {}, store).keyframes;
};

TEST(Split, PartsAMapAndMovesNothing) {
  Row row;
  row.store.Commit([&](MapCommit& commit) {
    commit.AddLoop(row.ids[1], row.ids[6]);
    commit.AddLoop(row.ids[5], row.ids[7]);
    commit.Remove(row.ids[4]);  // culled: anchors to it follow its parent
  });
  const MapSnapshot before = row.store.Snapshot();
  MapId younger;
  const MapSnapshot after =
      row.store.Commit([&](MapCommit& commit) { younger = commit.Split(row.ids[5]); });
  ExpectConsistent(after);
  EXPECT_EQ(after.KeyFramesOf(younger),
            std::vector<KeyFrameId>(row.ids.begin() + 5, row.ids.end()));
  EXPECT_EQ(after.KeyFramesOf(before.MapOf(row.ids[0])),
            std::vector<KeyFrameId>(row.ids.begin(), row.ids.begin() + 4));
  EXPECT_EQ(after.MapOf(row.ids[4]), before.MapOf(row.ids[0]));
  EXPECT_FALSE(after.Find(row.ids[5])->parent.valid());
  EXPECT_TRUE(after.Find(row.ids[6])->loops.empty());
  EXPECT_EQ(after.Find(row.ids[7])->loops, std::vector<KeyFrameId>{row.ids[5]});
  EXPECT_GT(after.corrections(), before.corrections());
  for (KeyFrameId id : after.KeyFrames()) {
    EXPECT_EQ(after.PoseOf(id).R, before.PoseOf(id).R);
    EXPECT_EQ(after.PoseOf(id).t, before.PoseOf(id).t);
  }
  int divided = 0;
  for (LandmarkId id : after.Landmarks()) {
    EXPECT_EQ(after.Find(id)->p_world, before.Find(id)->p_world);
    divided += after.Find(id)->observations.size() < before.Find(id)->observations.size();
  }
  EXPECT_GT(divided, 50);  // points observed by both parts
}

TEST(Split, IsUndoneByAMerge) {
  Row row;
  const MapId older = row.store.Snapshot().MapOf(row.ids[0]);
  MapId younger;
  row.store.Commit([&](MapCommit& commit) { younger = commit.Split(row.ids[3]); });
  const MapSnapshot after = row.store.Commit(
      [&](MapCommit& commit) { CommitMerge(commit, younger, older, Sim3{}, row.ids[2]); });
  ExpectConsistent(after);
  EXPECT_EQ(after.KeyFramesOf(older), row.ids);
}

TEST(Split, DoesNothingAtAMapsFirstKeyFrame) {
  Row row;
  MapId first, gone;
  const MapSnapshot after = row.store.Commit([&](MapCommit& commit) {
    first = commit.Split(row.ids[0]);
    gone = commit.Split(KeyFrameId{99});
  });
  EXPECT_EQ(first, after.MapOf(row.ids[0]));
  EXPECT_FALSE(gone.valid());
  EXPECT_EQ(after.Maps().size(), 1u);
}

}  // namespace
}  // namespace alidade::split_test
