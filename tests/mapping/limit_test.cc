#include "alidade/mapping/limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "alidade/mapping/mapper.h"
#include "problems/synthetic_map.h"
#include "support/check_map.h"

namespace alidade::limit_test {
namespace {

// Cameras along a wall; the first and the last have no common view.
SyntheticWorld LongWorld(int cameras) {
  return MakeSyntheticWorld({.points = 3000, .cameras = cameras, .step = 0.3, .turn = 0});
}

TEST(FindLeastUseful, NamesTheFirstAndTheNewestNeverAndThePresentPlaceLast) {
  MapStore store;
  const SyntheticMap made = FillMap(LongWorld(60), {}, store);
  const MapSnapshot map = store.Snapshot();
  const KeyFrameId newest = made.keyframes.back();
  const std::vector<KeyFrameId> named = FindLeastUseful(map, newest, 5);
  ASSERT_EQ(named.size(), 5u);
  for (KeyFrameId id : named) {
    for (const Neighbour& near : map.Find(newest)->covisible) EXPECT_NE(id, near.id);
  }
  EXPECT_EQ(FindLeastUseful(map, newest, 5), named);
  const std::vector<KeyFrameId> all = FindLeastUseful(map, newest, 1000);
  EXPECT_EQ(all.size(), made.keyframes.size() - 2);
  EXPECT_EQ(std::count(all.begin(), all.end(), made.keyframes.front()), 0);
  EXPECT_EQ(std::count(all.begin(), all.end(), newest), 0);
}

TEST(FindLeastUseful, PrefersWhatOthersSeeToo) {
  SyntheticWorldMaker maker({.points = 4000, .cameras = 50, .step = 0.5});
  const auto look = [&](double x) { maker.Look({Eigen::Matrix3d::Identity(), {-x, 0, 0}}); };
  look(0);
  for (int i = 0; i < 9; ++i) look(5 + 0.001 * i);  // at one place
  for (int i = 1; i <= 40; ++i) look(0.5 * i);
  MapStore store;
  const SyntheticMap made = FillMap(maker.Take(), {}, store);
  const MapSnapshot map = store.Snapshot();
  const std::vector<KeyFrameId> named = FindLeastUseful(map, made.keyframes.back(), 4);
  ASSERT_EQ(named.size(), 4u);
  for (KeyFrameId id : named) EXPECT_NEAR(map.Find(id)->Centre().x(), 5, 0.01);
}

TEST(MapperLimit, KeepsTheMapWithinItAndSound) {
  MapperSettings settings;
  settings.max_keyframes = 40;
  MapStore store;
  const SyntheticWorld world = LongWorld(60);
  const SyntheticMap made = FillMap(world, {}, store);
  Mapper mapper(store, world.camera, settings);
  EXPECT_EQ(mapper.KeepWithinLimit(made.keyframes.back()),
            // And 2 more, so that the limit is not reached again at once.
            22);
  const MapSnapshot map = store.Snapshot();
  EXPECT_EQ(map.keyframe_count(), 38);
  ExpectConsistent(map);
  EXPECT_EQ(mapper.KeepWithinLimit(made.keyframes.back()), 0);
}

}  // namespace
}  // namespace alidade::limit_test
