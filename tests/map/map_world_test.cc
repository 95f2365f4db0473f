// What is known of a map's world goes where the map goes: into files, merges, unions, parts.
#include "alidade/map/map_world.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "alidade/map/correction.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_union.h"
#include "support/expect_error.h"
#include "support/saved_map.h"
#include "two_keyframes.h"

namespace alidade::map_world_test {
namespace {

const Eigen::Vector3d kDown = Eigen::Vector3d(0.1, 0.9, -0.2).normalized();

MapWorld World(uint32_t map) { return {{map}, true, 0.02, kDown, 0.004}; }

SavedMap WithWorlds(SavedMap saved, const std::vector<MapWorld>& worlds) {
  MapStore store;
  store.Restore(saved.map);
  saved.map = store.Commit([&](MapCommit& commit) {
    for (const MapWorld& world : worlds) commit.SetWorld(world);
  });
  return saved;
}

TEST(MapWorld, IsSavedAndRead) {
  const SavedMap plain = MakeSavedMap(), saved = WithWorlds(plain, {World(1)});
  const SavedMap read = DecodeMap(EncodeMap(saved));
  EXPECT_EQ(read.map.WorldOf({0}), nullptr);
  ASSERT_NE(read.map.WorldOf({1}), nullptr);
  EXPECT_EQ(*read.map.WorldOf({1}), World(1));
  EXPECT_EQ(EncodeMap(read), EncodeMap(saved));
  MapWorld only_meters = World(0);
  only_meters.down.setZero();
  const SavedMap other = DecodeMap(EncodeMap(WithWorlds(saved, {only_meters})));
  EXPECT_EQ(*other.map.WorldOf({0}), only_meters);
  EXPECT_FALSE(other.map.WorldOf({0})->KnowsDown());
}

TEST(MapWorld, IsOfTheFileOnlyWhileItsMapExists) {
  SavedMap saved = WithWorlds(MakeSavedMap(), {World(0), World(1)});
  MapStore store;
  store.Restore(saved.map);
  saved.map = store.Commit([&](MapCommit& commit) { commit.Remove(MapId{1}); });
  EXPECT_EQ(saved.map.WorldOf({1}), nullptr);
  EXPECT_EQ(DecodeMap(EncodeMap(saved)).map.state().worlds.size(), 1u);
}

TEST(MapWorld, SaysWhetherLengthsAreMeters) {
  SavedMap saved = MakeSavedMap();
  EXPECT_TRUE(InMeters(saved, {0}));  // it has depth
  saved.sensor = "mono";
  EXPECT_FALSE(InMeters(saved, {0}));
  saved = WithWorlds(saved, {World(0)});
  EXPECT_TRUE(InMeters(saved, {0}));
  EXPECT_FALSE(InMeters(saved, {1}));
}

// Encoding checks its own result, so that what cannot be read is never written.
TEST(MapWorld, WhatCannotBeIsNotRead) {
  for (MapWorld bad : {World(0), World(0), World(0)}) {
    static int which = 0;
    if (which == 0) bad.down *= 2;
    if (which == 1) bad.scale_sigma = -1;
    if (which == 2) bad.down_sigma = std::numeric_limits<double>::quiet_NaN();
    ++which;
    EXPECT_THROW(EncodeMap(WithWorlds(MakeSavedMap(), {bad})), std::logic_error);
  }
}

class TwoMaps : public TwoKeyframes {
 protected:
  void SetUp() override {
    TwoKeyframes::SetUp();
    store_.Commit([&](MapCommit& commit) { c_ = commit.Add(BareKeyFrame(4)); });
    older_ = store_.Snapshot().MapOf(a_);
    younger_ = store_.Snapshot().MapOf(c_);
  }
  void Merge(const Sim3& T_older_younger) {
    store_.Commit(
        [&](MapCommit& commit) { CommitMerge(commit, younger_, older_, T_older_younger, b_); });
  }
  void Know(const MapWorld& world) {
    store_.Commit([&](MapCommit& commit) { commit.SetWorld(world); });
  }
  KeyFrameId c_;
  MapId older_, younger_;
};

TEST_F(TwoMaps, AMergedMapHasTheWorldOfTheOlder) {
  MapWorld other = World(younger_.value);
  other.down = Eigen::Vector3d::UnitX();
  Know(World(older_.value));
  Know(other);
  Merge({2, Eigen::Matrix3d::Identity(), {1, 0, 0}});
  EXPECT_EQ(*store_.Snapshot().WorldOf(older_), World(older_.value));
  EXPECT_EQ(store_.Snapshot().WorldOf(younger_), nullptr);
}

TEST_F(TwoMaps, TheVerticalIsTakenOverTurnedAndMetersAreNot) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()).toRotationMatrix();
  Know(World(younger_.value));
  Merge({2, R, {1, 0, 0}});
  const MapWorld* world = store_.Snapshot().WorldOf(older_);
  ASSERT_NE(world, nullptr);
  EXPECT_LT((world->down - R * kDown).norm(), 1e-12);
  EXPECT_FALSE(world->meters);
}

TEST_F(TwoMaps, BothPartsOfAMapStayInItsWorld) {
  Know(World(older_.value));
  MapId part;
  store_.Commit([&](MapCommit& commit) { part = commit.Split(b_); });
  ASSERT_NE(part, older_);
  EXPECT_EQ(*store_.Snapshot().WorldOf(part), World(part.value));
  EXPECT_EQ(*store_.Snapshot().WorldOf(older_), World(older_.value));
}

TEST_F(TwoMaps, AUnionKnowsTheWorldsOfAll) {
  Know(World(younger_.value));
  const MapSnapshot one = store_.Snapshot();
  const MapUnion all = Unite(std::vector<MapSnapshot>{one, one});
  const uint32_t shift = all.parts[1].first_map;
  ASSERT_GT(shift, 0u);
  EXPECT_EQ(*all.map.WorldOf(younger_), World(younger_.value));
  EXPECT_EQ(*all.map.WorldOf({younger_.value + shift}), World(younger_.value + shift));
}

}  // namespace
}  // namespace alidade::map_world_test
