#include "alidade/mapping/fuse.h"

#include <gtest/gtest.h>

#include <set>

#include "problems/synthetic_map.h"
#include "support/check_map.h"

namespace alidade::fuse_test {
namespace {

constexpr SyntheticWorldSettings kWorld{
    .points = 500, .cameras = 6, .noise_px = 0.5, .flipped_bits = 12, .clutter = 100};

// All keypoints of a landmark observe the same world point.
void ExpectNothingMixedUp(const SyntheticWorld& world, const MapSnapshot& map) {
  for (LandmarkId id : map.Landmarks()) {
    std::set<int> points;
    for (const Observation& o : map.Find(id)->observations) {
      points.insert(world.views[o.keyframe.value].points[o.keypoint]);
    }
    EXPECT_EQ(points.size(), 1u);
  }
}

TEST(FindDuplicates, MergesLandmarksThatAreTheSameTwice) {
  const SyntheticWorld world = MakeSyntheticWorld(kWorld);
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const KeyFrameId newest = made.keyframes.back();
  // Duplicates every second landmark of the newest keyframe: the observations of the last two views
  // are moved to a new landmark.
  std::vector<std::pair<LandmarkId, LandmarkId>> twins;
  store.Commit([&](MapCommit& commit) {
    for (size_t i = 0; i < made.landmarks.size(); i += 2) {
      const Landmark* landmark = commit.Find(made.landmarks[i]);
      if (!landmark || landmark->observations.size() < 5 ||
          landmark->observations.back().keyframe != newest)
        continue;
      Landmark twin = *landmark;
      twin.observations.assign(landmark->observations.end() - 2, landmark->observations.end());
      twin.reference = twin.born = twin.observations.front().keyframe;
      const std::vector<Observation> moved = twin.observations;
      for (const Observation& o : moved) commit.RemoveObservation(made.landmarks[i], o.keyframe);
      twins.push_back({made.landmarks[i], commit.Add(std::move(twin))});
      commit.RefreshLandmark(twins.back().first);
      commit.RefreshLandmark(twins.back().second);
    }
    for (KeyFrameId id : made.keyframes) commit.RefreshCovisibility(id);
  });
  ASSERT_GT(twins.size(), 50u);
  const auto duplicates = FindDuplicates(store.Snapshot(), newest, world.camera, {});
  store.Commit([&](MapCommit& commit) {
    for (LandmarkId id : CommitFusion(commit, duplicates)) commit.RefreshLandmark(id);
  });
  const MapSnapshot map = store.Snapshot();
  ExpectConsistent(map);
  ExpectNothingMixedUp(world, map);
  int merged = 0;
  for (const auto& [one, other] : twins) merged += map.Current(one) == map.Current(other);
  EXPECT_GE(merged, 0.95 * static_cast<double>(twins.size()));
}

TEST(FindDuplicates, FindsSightingsNobodyNoticed) {
  const SyntheticWorld world = MakeSyntheticWorld(kWorld);
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const KeyFrameId newest = made.keyframes.back();
  // Landmark, and its keypoint in the newest keyframe.
  std::vector<std::pair<LandmarkId, int>> forgotten;
  store.Commit([&](MapCommit& commit) {
    const std::vector<LandmarkId> seen = commit.Find(newest)->landmarks;
    for (size_t k = 0; k < seen.size(); k += 3) {
      if (!seen[k].valid() || commit.Find(seen[k])->observations.size() < 3) continue;
      commit.RemoveObservation(seen[k], newest);
      commit.RefreshLandmark(seen[k]);
      forgotten.push_back({seen[k], static_cast<int>(k)});
    }
    commit.RefreshCovisibility(newest);
  });
  ASSERT_GT(forgotten.size(), 30u);
  const auto found = FindDuplicates(store.Snapshot(), newest, world.camera, {});
  store.Commit([&](MapCommit& commit) { CommitFusion(commit, found); });
  const MapSnapshot map = store.Snapshot();
  ExpectConsistent(map);
  ExpectNothingMixedUp(world, map);
  int back = 0;
  for (const auto& [id, keypoint] : forgotten) back += map.Find(newest)->landmarks[keypoint] == id;
  EXPECT_GE(back, 0.95 * static_cast<double>(forgotten.size()));
}

TEST(FindDuplicates, HasNothingToSayAboutAMapThatIsComplete) {
  const SyntheticWorld world = MakeSyntheticWorld(kWorld);
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const MapSnapshot before = store.Snapshot();
  const auto found = FindDuplicates(before, made.keyframes.back(), world.camera, {});
  store.Commit([&](MapCommit& commit) { CommitFusion(commit, found); });
  EXPECT_EQ(store.Snapshot().landmark_count(), before.landmark_count());
}

TEST(CommitFusion, PassesOverWhatIsGoneSince) {
  const SyntheticWorld world = MakeSyntheticWorld(kWorld);
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const LandmarkId alive = store.Snapshot().Find(made.keyframes[0])->landmarks[0].valid()
                               ? store.Snapshot().Find(made.keyframes[0])->landmarks[0]
                               : store.Snapshot().Landmarks().front();
  store.Commit([&](MapCommit& commit) {
    const LandmarkId gone = store.Snapshot().Landmarks().back();
    commit.Remove(gone);
    EXPECT_TRUE(
        CommitFusion(commit, {{gone, made.keyframes[1], 0}, {alive, KeyFrameId{99}, 0}}).empty());
  });
  ExpectConsistent(store.Snapshot());
}

}  // namespace
}  // namespace alidade::fuse_test
