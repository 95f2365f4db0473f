// Loop closures and merges move every keyframe close to the truth and leave a consistent map.
#include "alidade/looping/close.h"

#include <gtest/gtest.h>

#include "looping/old_place.h"
#include "support/check_map.h"

namespace alidade::close_test {
namespace {

constexpr int kView = 32, kPlace = 1;

// Largest error of a keyframe's center (meters), rotation and scale.
struct Errors {
  double position = 0, turn = 0, scale = 0;
};

Errors ErrorsOf(const OldPlace& place) {
  const MapSnapshot map = place.map();
  Errors errors;
  for (size_t i = 0; i < place.made.keyframes.size(); ++i) {
    const KeyFrame& keyframe = *map.Find(place.made.keyframes[i]);
    const Se3& truth = place.world.views[i].T_camera_world;
    errors.position = std::max(errors.position, Apart(keyframe.T_camera_world, truth));
    errors.turn = std::max(errors.turn, RotationAngle(keyframe.T_camera_world, truth));
    const double scale = place.made.scales[i] * keyframe.scale;
    errors.scale = std::max(errors.scale, std::abs(std::log(scale)));
  }
  return errors;
}

bool Covisible(const KeyFrame& keyframe, KeyFrameId other) {
  return std::any_of(keyframe.covisible.begin(), keyframe.covisible.end(),
                     [&](const Neighbour& n) { return n.id == other; });
}

// Drift in each step, as of odometry: vertical translation and rotation about the vertical, which
// accumulate around the ring (a lateral drift would only enlarge the ring).
DriftedMapSettings DriftAllAlong(double metres, double radians, double growth = 1) {
  DriftedMapSettings settings;
  settings.drift << 0, metres / kViews, 0, 0, radians / kViews, 0;
  settings.growth = std::pow(growth, 1.0 / kViews);
  return settings;
}

void CloseAndCheck(OldPlace& place, double position, double scale) {
  const Errors before = ErrorsOf(place);
  const MapSnapshot drifted = place.map();
  const auto match = place.Verify(kView, kPlace);
  ASSERT_TRUE(match);
  const LoopCorrection loop = CorrectLoop(drifted, *match, place.world.camera, place.settings);
  EXPECT_FALSE(loop.merges());
  bool done = false;
  place.store.Commit([&](MapCommit& commit) { done = CommitLoop(commit, loop); });
  ASSERT_TRUE(done);
  const MapSnapshot map = place.map();
  ExpectConsistent(map);
  const Errors after = ErrorsOf(place);
  EXPECT_LT(after.position, position);
  EXPECT_LT(after.position, 0.4 * before.position);
  EXPECT_LT(after.scale, scale);
  EXPECT_LT(after.turn, 0.2 * before.turn);
  EXPECT_EQ(map.corrections(), drifted.corrections() + 1);

  const KeyFrame &here = *map.Find(match->keyframe), &there = *map.Find(match->place);
  EXPECT_EQ(here.loops, std::vector<KeyFrameId>{match->place});
  EXPECT_EQ(there.loops, std::vector<KeyFrameId>{match->keyframe});
  EXPECT_TRUE(Covisible(here, there.id));
  // The first keyframe defines the world frame.
  EXPECT_EQ(map.PoseOf(place.KeyFrameOf(0)).t, drifted.PoseOf(place.KeyFrameOf(0)).t);
  // Duplicate landmarks are merged: nearly all found by the match.
  EXPECT_GT(drifted.landmark_count() - map.landmark_count(),
            static_cast<int>(0.8 * static_cast<double>(match->found.size())));
  int wrong = 0, all = 0;
  for (LandmarkId id : map.Landmarks()) {
    int point = -1;
    for (const Observation& o : map.Find(id)->observations) {
      const int shown = place.world.views[map.Find(o.keyframe)->frame->number].points[o.keypoint];
      wrong += point >= 0 && shown != point;
      point = shown;
      ++all;
    }
  }
  EXPECT_LT(wrong, 0.01 * all);
}

TEST(CloseLoop, WithDepthBringsEveryKeyFrameHome) {
  auto place = ComeBack({.depth = true, .drifted = DriftAllAlong(1.2, 0.2)});
  CloseAndCheck(*place, 0.25, 1e-9);
}

TEST(CloseLoop, WithOneCameraMendsTheScaleToo) {
  for (double growth : {1.25, 0.8}) {
    SCOPED_TRACE(growth);
    auto place = ComeBack({.drifted = DriftAllAlong(0.4, 0.1, growth)});
    CloseAndCheck(*place, 0.3, 0.07);
  }
}

// Keyframes of the old place that share a few landmarks with the returning keyframe (distant ones,
// in a corridor) must not be moved with it.
TEST(CloseLoop, APlaceThatSharesALittleIsNotMovedAlong) {
  auto place = ComeBack({.drifted = DriftAllAlong(0.4, 0.1, 1.25)});
  ShareATenth(*place, kView, kPlace);
  const MapSnapshot map = place->map();
  ASSERT_TRUE(Covisible(*map.Find(place->KeyFrameOf(kView)), place->KeyFrameOf(kPlace)));
  const auto match = place->Verify(kView, kPlace);
  ASSERT_TRUE(match);
  // Number of the old place's keyframes in the window.
  const auto moved = [&](const LoopSettings& settings) {
    const auto window = CorrectLoop(map, *match, place->world.camera, settings).window;
    return std::count_if(window.begin(), window.end(),
                         [&](KeyFrameId id) { return id < place->KeyFrameOf(kLap / 2); });
  };
  EXPECT_EQ(moved(place->settings), 0);
  LoopSettings any = place->settings;
  any.tied_share = 0;
  EXPECT_GT(moved(any), 0);
  CloseAndCheck(*place, 0.3, 0.07);
}

// Closing a second loop after the first.
TEST(CloseLoop, TwiceIsNoWorse) {
  auto place = ComeBack({.depth = true, .drifted = DriftAllAlong(1.2, 0.2)});
  CloseAndCheck(*place, 0.25, 1e-9);
  const Errors once = ErrorsOf(*place);
  const auto match = place->Verify(kView + 2, kPlace + 2);
  ASSERT_TRUE(match);
  const LoopCorrection loop =
      CorrectLoop(place->map(), *match, place->world.camera, place->settings);
  place->store.Commit([&](MapCommit& commit) { EXPECT_TRUE(CommitLoop(commit, loop)); });
  ExpectConsistent(place->map());
  EXPECT_LT(ErrorsOf(*place).position, 1.2 * once.position);
}

// Objects created between correction and commit follow.
TEST(CloseLoop, WhatIsBornMeanwhileComesAlong) {
  auto place = ComeBack({.drifted = DriftAllAlong(0.4, 0.1, 1.25)});
  const auto match = place->Verify(kView, kPlace);
  ASSERT_TRUE(match);
  const LoopCorrection loop =
      CorrectLoop(place->map(), *match, place->world.camera, place->settings);
  const KeyFrameId parent = place->KeyFrameOf(kViews - 1);
  const Se3 step = Se3::Exp((Vector6d() << 0.2, 0, 0.1, 0, 0.1, 0).finished());
  KeyFrameId young;
  const MapSnapshot before = place->store.Commit([&](MapCommit& commit) {
    KeyFrame keyframe;
    keyframe.frame = place->world.views.back().frame;
    keyframe.parent = parent;
    keyframe.T_camera_world = step * commit.Find(parent)->T_camera_world;
    young = commit.Add(std::move(keyframe));
  });
  const MapSnapshot after =
      place->store.Commit([&](MapCommit& commit) { EXPECT_TRUE(CommitLoop(commit, loop)); });
  ExpectConsistent(after);
  Se3 expected = step;
  expected.t *= after.ScaleOf(parent);
  const Se3 found = after.PoseOf(young) * after.PoseOf(parent).Inverse();
  EXPECT_NE(after.ScaleOf(parent), 1);
  EXPECT_LT((found.t - expected.t).norm(), 1e-9);
  EXPECT_LT(RotationAngle(found, expected), 1e-6);
}

TEST(CloseLoop, NothingIsDoneWhenThePlaceIsGone) {
  auto place = ComeBack({.depth = true, .drifted = DriftAllAlong(1.2, 0.2)});
  const auto match = place->Verify(kView, kPlace);
  ASSERT_TRUE(match);
  const LoopCorrection loop =
      CorrectLoop(place->map(), *match, place->world.camera, place->settings);
  place->store.Commit([&](MapCommit& commit) { commit.Remove(match->place); });
  const MapSnapshot before = place->map();
  place->store.Commit([&](MapCommit& commit) { EXPECT_FALSE(CommitLoop(commit, loop)); });
  EXPECT_EQ(place->map().corrections(), before.corrections());
  EXPECT_EQ(place->map().landmark_count(), before.landmark_count());
}

// Two maps of the ring that overlap at the first one's start; the second has its own world frame
// (and scale if monocular). `view` and `at` may be in either map.
void MergeAndCheck(bool depth, int view, int at, double bound) {
  SCOPED_TRACE(std::to_string(view) + (depth ? " with depth" : ""));
  OldPlace place;
  place.world = MakeRing({.depth = depth});
  const Sim3 T_map_world{depth ? 1 : 2.3, ExpSo3({0.4, -1.1, 0.2}), {4, -2, 3}};
  place.made = FillDriftedMap(place.world, {.count = 18}, place.store);
  const DriftedMap second =
      FillDriftedMap(place.world, {.first = 18, .T_map_world = T_map_world}, place.store);
  place.made.keyframes.insert(place.made.keyframes.end(), second.keyframes.begin(),
                              second.keyframes.end());
  place.made.scales.insert(place.made.scales.end(), second.scales.begin(), second.scales.end());
  ASSERT_EQ(place.map().Maps().size(), 2u);
  const auto match = place.Verify(view, at);
  ASSERT_TRUE(match);
  const LoopCorrection loop = CorrectLoop(place.map(), *match, place.world.camera, place.settings);
  EXPECT_TRUE(loop.merges());
  EXPECT_NEAR(loop.T_older_younger.s, 1 / T_map_world.s, 0.005 / T_map_world.s);
  const MapSnapshot before = place.map();
  const MapSnapshot after =
      place.store.Commit([&](MapCommit& commit) { EXPECT_TRUE(CommitLoop(commit, loop)); });
  ExpectConsistent(after);
  EXPECT_EQ(after.Maps(), std::vector<MapId>{MapId{0}});
  const Errors errors = ErrorsOf(place);
  EXPECT_LT(errors.position, bound);
  EXPECT_LT(errors.turn, 0.01);
  EXPECT_LT(errors.scale, 0.006);
  EXPECT_GT(before.landmark_count() - after.landmark_count(), 50);
  EXPECT_TRUE(Covisible(*after.Find(match->keyframe), match->place));
}

TEST(MergeMaps, WhenTheYoungerComesToThePlaceOfTheOlder) {
  MergeAndCheck(true, kView, kPlace, 0.05);
  MergeAndCheck(false, kView, kPlace, 0.06);
}

TEST(MergeMaps, WhenTheOlderComesToThePlaceOfTheYounger) {
  MergeAndCheck(true, kPlace, kView, 0.05);
  MergeAndCheck(false, kPlace, kView, 0.06);
}

}  // namespace
}  // namespace alidade::close_test
