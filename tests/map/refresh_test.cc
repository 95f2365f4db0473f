// Data derived by commits: covisibility and search data of landmarks.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "alidade/map/map_store.h"
#include "problems/synthetic_map.h"
#include "support/check_map.h"

namespace alidade::refresh_test {
namespace {

int SharedLandmarks(const KeyFrame& a, const KeyFrame& b) {
  std::set<LandmarkId> seen_by_a;
  for (LandmarkId id : a.landmarks) {
    if (id.valid()) seen_by_a.insert(id);
  }
  int shared = 0;
  for (LandmarkId id : b.landmarks) shared += id.valid() && seen_by_a.count(id) > 0;
  return shared;
}

TEST(RefreshCovisibility, EqualsCountingByBruteForce) {
  // Large steps: pairs with many shared landmarks, with fewer than the minimum of 15, and with
  // none.
  const SyntheticWorld world =
      MakeSyntheticWorld({.points = 300, .cameras = 12, .step = 0.9, .turn = 0});
  MapStore store;
  FillMap(world, {.known = 0.6}, store);
  const MapSnapshot map = store.Snapshot();
  ExpectConsistent(map);
  int pairs = 0, weak_pairs = 0;
  for (KeyFrameId a : map.KeyFrames()) {
    // By descending number of shared landmarks, then by id.
    std::vector<std::pair<int, KeyFrameId>> expected;
    for (KeyFrameId b : map.KeyFrames()) {
      const int shared = a == b ? 0 : SharedLandmarks(*map.Find(a), *map.Find(b));
      weak_pairs += shared > 0 && shared < 15;
      if (shared >= 15) expected.push_back({-shared, b});
    }
    std::sort(expected.begin(), expected.end());
    ASSERT_FALSE(expected.empty());
    const std::vector<Neighbour>& covisible = map.Find(a)->covisible;
    ASSERT_EQ(covisible.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(covisible[i].id, expected[i].second);
      EXPECT_EQ(covisible[i].shared, -expected[i].first);
    }
    pairs += static_cast<int>(expected.size());
  }
  EXPECT_GT(pairs, 20);  // ensures that both cases occur
  EXPECT_GT(weak_pairs, 4);
}

TEST(RefreshCovisibility, KeepsTheBestNeighbourOfAKeyframeThatSharesLittle) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 30, .cameras = 2});
  MapStore store;
  const SyntheticMap made = FillMap(world, {.known = 0.3}, store);
  const MapSnapshot map = store.Snapshot();
  const int shared = SharedLandmarks(*map.Find(made.keyframes[0]), *map.Find(made.keyframes[1]));
  ASSERT_GT(shared, 0);
  ASSERT_LT(shared, 15);
  ASSERT_EQ(map.Find(made.keyframes[0])->covisible.size(), 1u);
  EXPECT_EQ(map.Find(made.keyframes[0])->covisible[0].shared, shared);
}

TEST(RefreshCovisibility, ForgetsNeighboursThatNoLongerShare) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 200, .cameras = 4});
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const KeyFrameId a = made.keyframes[0], b = made.keyframes[1];
  store.Commit([&](MapCommit& commit) {
    for (LandmarkId id : std::vector<LandmarkId>(commit.Find(a)->landmarks)) {
      if (id.valid()) commit.RemoveObservation(id, b);
    }
    commit.RefreshCovisibility(a);
  });
  const MapSnapshot map = store.Snapshot();
  for (const Neighbour& n : map.Find(a)->covisible) EXPECT_NE(n.id, b);
  for (const Neighbour& n : map.Find(b)->covisible) EXPECT_NE(n.id, a);
}

TEST(RefreshLandmark, TakesTheDescriptorNearestToTheOthers) {
  Random random(5);
  const Descriptor typical = RandomDescriptor(random);
  MapStore store;
  LandmarkId id;
  store.Commit([&](MapCommit& commit) {
    Landmark landmark;
    landmark.p_world = {0, 0, 4};
    for (int i = 0; i < 5; ++i) {
      auto frame = std::make_shared<Frame>();
      frame->keypoints.resize(1);
      // The third descriptor is the representative: the others differ from it by 20 bits, and more
      // from each other.
      frame->descriptors = {i == 2 ? typical : WithFlippedBits(typical, 20, random)};
      KeyFrame keyframe;
      keyframe.frame = frame;
      if (i > 0) keyframe.parent = KeyFrameId{0};
      landmark.observations.push_back({commit.Add(std::move(keyframe)), 0});
    }
    landmark.reference = landmark.observations.front().keyframe;
    id = commit.Add(std::move(landmark));
    commit.RefreshLandmark(id);
  });
  EXPECT_EQ(store.Snapshot().Find(id)->descriptor, typical);
}

TEST(RefreshLandmark, KnowsDirectionAndRangeOfScales) {
  MapStore store;
  LandmarkId id;
  store.Commit([&](MapCommit& commit) {
    Landmark landmark;
    landmark.p_world = {0, 0, 4};
    for (double x : {-1.0, 1.0}) {
      auto frame = std::make_shared<Frame>();
      frame->keypoints.resize(1);
      frame->keypoints[0].level = 3;
      frame->descriptors.resize(1);
      KeyFrame keyframe;
      keyframe.frame = frame;
      keyframe.T_camera_world.t = {-x, 0, 0};
      landmark.observations.push_back({commit.Add(std::move(keyframe)), 0});
    }
    landmark.reference = landmark.observations.front().keyframe;
    id = commit.Add(std::move(landmark));
    commit.RefreshLandmark(id);
  });
  const MapSnapshot map = store.Snapshot();
  const Landmark& landmark = *map.Find(id);
  EXPECT_LT((landmark.normal - Eigen::Vector3f(0, 0, 1)).norm(),
            1e-6);  // mean of two mirrored directions
  const double distance = std::sqrt(17.0), scale = std::pow(1.2, 3);
  EXPECT_NEAR(landmark.max_distance, distance * scale, 1e-5);  // at this distance it is on level 0
  EXPECT_NEAR(landmark.min_distance, distance * scale / std::pow(1.2, 7),
              1e-5);  // at this distance it is on the last level
}

TEST(RefreshLandmark, RemovesOneThatNobodySees) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 50, .cameras = 2});
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const LandmarkId id = store.Snapshot().Landmarks().front();
  store.Commit([&](MapCommit& commit) {
    commit.RemoveObservation(id, made.keyframes[0]);
    commit.RemoveObservation(id, made.keyframes[1]);
    commit.RefreshLandmark(id);
  });
  EXPECT_EQ(store.Snapshot().Find(id), nullptr);
  ExpectConsistent(store.Snapshot());
}

}  // namespace
}  // namespace alidade::refresh_test
