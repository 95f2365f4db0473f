// The loop closer: candidates, loop closure, merging, full adjustment.
#include "alidade/looping/loop_closer.h"

#include <gtest/gtest.h>

#include <numbers>

#include "alidade/looping/candidates.h"
#include "looping/old_place.h"
#include "problems/synthetic_map.h"
#include "support/check_map.h"

namespace alidade::loop_closer_test {
namespace {

void AtOnce(const std::function<void()>& commit) { commit(); }

TEST(LoopCandidates, AreOldPlacesAndNothingNear) {
  const auto place = ComeBack({.depth = true, .drifted = DriftInTheMiddle(0.4, 0.1)});
  const MapSnapshot map = place->map();
  for (int view : {31, 32, 33, 34}) {
    SCOPED_TRACE(view);
    PlaceIndex places;
    for (int v = 0; v < view; ++v) places.Add(place->KeyFrameOf(v), place->world.views[v].frame);
    const KeyFrameId id = place->KeyFrameOf(view);
    const auto found = FindLoopCandidates(map, places, id, place->settings);
    ASSERT_FALSE(found.empty());
    EXPECT_LE(found.size(), 3u);
    // The best candidate is the view from the same position on the ring, or an adjacent one.
    EXPECT_NEAR(static_cast<int>(found[0].value), view - kLap, 1);
    const KeyFrame& keyframe = *map.Find(id);
    for (KeyFrameId candidate : found) {
      EXPECT_NE(candidate, id);
      for (const Neighbour& n : keyframe.covisible) {
        EXPECT_NE(candidate, n.id);
        for (const Neighbour& second : map.Find(n.id)->covisible) EXPECT_NE(candidate, second.id);
      }
      for (KeyFrameId other : found) {  // each candidate represents a different group
        for (const Neighbour& n : map.Find(candidate)->covisible) EXPECT_NE(n.id, other);
      }
    }
  }
}

bool IsAmong(const std::vector<KeyFrameId>& found, int view) {
  return std::any_of(found.begin(), found.end(), [&](KeyFrameId candidate) {
    return std::abs(static_cast<int>(candidate.value) - view) <= 1;
  });
}

// The camera shares a tenth of its landmarks with the old place: distant ones in a corridor, which
// constrain neither its position nor its scale.
TEST(LoopCandidates, AFewSharedLandmarksDoNotTieAPlace) {
  const auto place = ComeBack({.drifted = DriftInTheMiddle(0.4, 0.1)});
  constexpr int kView = 32, kOld = kView - kLap;
  const KeyFrameId id = place->KeyFrameOf(kView);
  ShareATenth(*place, kView, kOld);
  PlaceIndex places;
  for (int v = 0; v < kView; ++v) places.Add(place->KeyFrameOf(v), place->world.views[v].frame);
  const auto found = [&] {
    return IsAmong(FindLoopCandidates(place->map(), places, id, place->settings), kOld);
  };
  EXPECT_TRUE(found());
  place->settings.tied_share = 0;
  EXPECT_FALSE(found());
}

TEST(LoopCandidates, FaceTheSameWay) {
  const auto place = ComeBack({.drifted = DriftInTheMiddle(0, 2.5)});  // radians
  PlaceIndex places;
  for (int v = 0; v < 32; ++v) places.Add(place->KeyFrameOf(v), place->world.views[v].frame);
  const auto found = [&] {
    return IsAmong(FindLoopCandidates(place->map(), places, place->KeyFrameOf(32), place->settings),
                   2);
  };
  EXPECT_FALSE(found());
  place->settings.max_view_turn = 3.2;
  EXPECT_TRUE(found());
}

TEST(LoopCandidates, GroupsAreStoodForByTheirBest) {
  const auto place = ComeBack({.depth = true});
  const MapSnapshot map = place->map();
  PlaceIndex places;
  for (int v = 0; v < 20; ++v) places.Add(place->KeyFrameOf(v), place->world.views[v].frame);
  const KeyFrameId id = place->KeyFrameOf(33);
  LoopSettings settings;
  settings.group = settings.candidates = 20;
  settings.score_share = 0;
  const auto found = FindLoopCandidates(map, places, id, settings);
  const auto score = [&](KeyFrameId other) { return places.Score(*map.Find(id)->frame, other); };
  for (KeyFrameId candidate : found) {
    for (const Neighbour& n : map.Find(candidate)->covisible) {
      if (score(n.id) <= score(candidate)) continue;
      // Left out despite a higher score: then a better keyframe of its group is a candidate.
      const bool stood_for = std::any_of(found.begin(), found.end(), [&](KeyFrameId other) {
        const auto& group = map.Find(n.id)->covisible;
        return score(other) >= score(n.id) &&
               std::any_of(group.begin(), group.end(),
                           [&](const Neighbour& m) { return m.id == other; });
      });
      EXPECT_TRUE(stood_for);
    }
  }
  for (size_t i = 1; i < found.size(); ++i) EXPECT_GE(score(found[i - 1]), score(found[i]));
}

TEST(LoopCandidates, WhatIsMuchLessLikeThanTheNeighboursIsNone) {
  const auto place = ComeBack({.depth = true});
  PlaceIndex places;
  for (int v = 0; v < 24; ++v) {
    if (v > 6) places.Add(place->KeyFrameOf(v), place->world.views[v].frame);
  }
  // The index contains only the keyframe's neighbors.
  EXPECT_TRUE(
      FindLoopCandidates(place->map(), places, place->KeyFrameOf(24), place->settings).empty());
}

TEST(LoopCloser, FindsTheLoopAtTheKeyFrameThatComesBackAndClosesIt) {
  for (bool depth : {true, false}) {
    SCOPED_TRACE(depth);
    const auto place =
        ComeBack({.depth = depth, .drifted = DriftInTheMiddle(1.0, 0.15, depth ? 1 : 1.2)});
    PlaceIndex places;
    LoopCloser closer(place->store, places, place->world.camera, place->settings);
    std::optional<LoopMatch> match;
    int view = 0;
    for (; view < kViews && !match; ++view) match = closer.Add(place->KeyFrameOf(view));
    ASSERT_TRUE(match);
    --view;
    EXPECT_GE(view, kLap - 3);  // not before the start is in view again
    EXPECT_LE(view, kLap + 2);
    EXPECT_EQ(places.size(), view + 1);
    EXPECT_EQ(match->keyframe, place->KeyFrameOf(view));
    EXPECT_TRUE(closer.Close(*match));
    EXPECT_EQ(closer.loops(), 1);
    EXPECT_EQ(closer.merges(), 0);
    const MapSnapshot map = place->map();
    ExpectConsistent(map);
    EXPECT_LT(Apart(map.PoseOf(place->KeyFrameOf(view)), place->world.views[view].T_camera_world),
              0.1);
    closer.AdjustAll(match->keyframe, nullptr, AtOnce);
    ExpectConsistent(place->map());
    for (int v = 0; v < kViews; ++v) {
      EXPECT_LT(
          Apart(place->map().PoseOf(place->KeyFrameOf(v)), place->world.views[v].T_camera_world),
          0.1);
    }
  }
}

// A ring whose second half looks exactly like the first: a second map matches either half.
TEST(LoopCloser, TakesNoneOfTwoPlacesOfAnotherMapThatWouldDoAsWell) {
  for (bool symmetric : {false, true}) {
    SCOPED_TRACE(symmetric);
    OldPlace place;
    place.world = MakeRing({.depth = true});
    const int points = static_cast<int>(place.world.points.size()), half = kLap / 2;
    const Se3 turn{ExpSo3({0, std::numbers::pi, 0}), {0, 0, -6}};  // about the center of the ring
    for (int i = 0; i < points; ++i) {
      const Eigen::Vector3d p = turn * place.world.points[i];
      place.world.points.push_back(p);
    }
    for (int v = half; v < kLap && symmetric; ++v) {
      SyntheticView view = place.world.views[v - half];
      view.T_camera_world = view.T_camera_world * turn.Inverse();
      for (int& point : view.points) {
        if (point >= 0) point += points;
      }
      place.world.views[v] = view;
    }
    const Sim3 T_map_world{1, ExpSo3({0.4, -1.1, 0.2}), {4, -2, 3}};
    place.made = FillDriftedMap(place.world, {.count = kLap}, place.store);
    const DriftedMap second =
        FillDriftedMap(place.world, {.first = kLap, .T_map_world = T_map_world}, place.store);
    PlaceIndex places;
    LoopCloser closer(place.store, places, place.world.camera, place.settings);
    for (KeyFrameId id : place.made.keyframes) places.Add(id, place.map().Find(id)->frame);
    EXPECT_EQ(closer.Add(second.keyframes[3]).has_value(), !symmetric);
  }
}

TEST(LoopCloser, ForgetsWhatWasCulled) {
  const auto place = ComeBack({.depth = true});
  PlaceIndex places;
  LoopCloser closer(place->store, places, place->world.camera, place->settings);
  for (int v = 0; v < 6; ++v) closer.Add(place->KeyFrameOf(v));
  EXPECT_EQ(places.size(), 6);
  place->store.Commit([&](MapCommit& commit) {
    commit.Remove(place->KeyFrameOf(2));
    commit.Remove(place->KeyFrameOf(4));
    commit.Remove(place->KeyFrameOf(7));
  });
  EXPECT_FALSE(closer.Add(place->KeyFrameOf(7)));  // culled before Add()
  EXPECT_EQ(places.size(), 4);
  closer.Add(place->KeyFrameOf(6));
  EXPECT_EQ(places.size(), 5);
  const Frame& gone = *place->world.views[2].frame;
  EXPECT_EQ(places.Score(gone, place->KeyFrameOf(2)), 0);
}

TEST(LoopCloser, SwitchedOffStillKnowsThePlaces) {
  const auto place = ComeBack({.depth = true});
  PlaceIndex places;
  LoopSettings settings;
  settings.enabled = false;
  LoopCloser closer(place->store, places, place->world.camera, settings);
  for (int v = 0; v < kViews; ++v) EXPECT_FALSE(closer.Add(place->KeyFrameOf(v)));
  EXPECT_EQ(places.size(), kViews);
}

TEST(LoopCloser, DoesNotCloseWhatIsGone) {
  const auto place = ComeBack({.depth = true, .drifted = DriftInTheMiddle(1.0, 0.15)});
  PlaceIndex places;
  LoopCloser closer(place->store, places, place->world.camera, place->settings);
  const auto match = place->Verify(32, 1);
  ASSERT_TRUE(match);
  place->store.Commit([&](MapCommit& commit) { commit.Remove(match->keyframe); });
  EXPECT_FALSE(closer.Close(*match));
  EXPECT_EQ(closer.loops(), 0);
}

// A map with errors in all poses and landmarks, and the true world.
struct Unsettled {
  SyntheticWorld world =
      MakeSyntheticWorld({.points = 300, .cameras = 8, .flipped_bits = 10, .depth = true});
  MapStore store;
  SyntheticMap made =
      FillMap(world, {.pose_sigma = 0.02, .point_sigma = 0.04, .keyframes = 7}, store);
  PlaceIndex places;
  LoopCloser closer{store, places, world.camera, {}};

  double Error() const {  // mean position error of the keyframes, meters
    double sum = 0;
    for (size_t i = 0; i < made.keyframes.size(); ++i)
      sum += Apart(store.Snapshot().PoseOf(made.keyframes[i]), world.views[i].T_camera_world);
    return sum / static_cast<double>(made.keyframes.size());
  }
};

TEST(AdjustAll, BringsTheMapToTheTruth) {
  Unsettled map;
  const double before = map.Error();
  EXPECT_GT(before, 0.015);
  const uint64_t corrections = map.store.Snapshot().corrections();
  map.closer.AdjustAll(map.made.keyframes.back(), nullptr, AtOnce);
  EXPECT_LT(map.Error(), 2e-4);  // keypoints are exact up to float precision
  EXPECT_EQ(map.store.Snapshot().corrections(), corrections + 1);
  ExpectConsistent(map.store.Snapshot());
  const Se3 root = map.store.Snapshot().PoseOf(map.made.keyframes[0]);
  EXPECT_EQ(root.t, map.world.views[0].T_camera_world.t);
}

TEST(AdjustAll, TakesAlongWhatWasMappedMeanwhile) {
  Unsettled map;
  const KeyFrameId parent = map.made.keyframes.back();
  const Se3 step = map.world.views[7].T_camera_world * map.world.views[6].T_camera_world.Inverse();
  KeyFrameId young;
  LandmarkId point;
  Eigen::Vector3d p_parent;
  map.closer.AdjustAll(parent, nullptr, [&](const std::function<void()>& commit_result) {
    map.store.Commit([&](MapCommit& commit) {
      KeyFrame keyframe;
      keyframe.frame = map.world.views[7].frame;
      keyframe.parent = parent;
      keyframe.T_camera_world = step * commit.Find(parent)->T_camera_world;
      young = commit.Add(std::move(keyframe));
      Landmark landmark;
      landmark.reference = landmark.born = parent;
      landmark.p_world = Eigen::Vector3d(0.3, -0.2, 4);
      p_parent = commit.Find(parent)->T_camera_world * landmark.p_world;
      for (size_t k = 0; k < commit.Find(parent)->landmarks.size(); ++k) {
        if (commit.Find(parent)->landmarks[k].valid()) continue;
        landmark.observations = {{parent, static_cast<int>(k)}};
        break;
      }
      ASSERT_FALSE(landmark.observations.empty());
      point = commit.Add(std::move(landmark));
    });
    commit_result();
  });
  const MapSnapshot after = map.store.Snapshot();
  ExpectConsistent(after);
  EXPECT_LT(map.Error(), 2e-4);
  // The correction is exact, so the new keyframe is at its true pose.
  EXPECT_LT(Apart(after.PoseOf(young), map.world.views[7].T_camera_world), 1e-3);
  EXPECT_LT((after.PoseOf(parent) * after.Find(point)->p_world - p_parent).norm(), 1e-9);
}

TEST(AdjustAll, IsDroppedWhenALoopWasClosedMeanwhile) {
  Unsettled map;
  const double before = map.Error();
  map.closer.AdjustAll(map.made.keyframes.back(), nullptr,
                       [&](const std::function<void()>& commit_result) {
                         map.store.Commit([](MapCommit& commit) { commit.CountCorrection(); });
                         commit_result();
                       });
  EXPECT_EQ(map.Error(), before);
}

TEST(AdjustAll, IsCutShort) {
  Unsettled map;
  const double before = map.Error();
  const std::atomic<bool> stop{true};
  map.closer.AdjustAll(map.made.keyframes.back(), &stop, AtOnce);
  EXPECT_NEAR(map.Error(), before, 1e-9);
  ExpectConsistent(map.store.Snapshot());
}

TEST(AdjustAll, LeavesOtherMapsAlone) {
  Unsettled map;
  const SyntheticMap other = FillMap(map.world, {.pose_sigma = 0.02, .keyframes = 4}, map.store);
  std::vector<Se3> before;
  for (KeyFrameId id : other.keyframes) before.push_back(map.store.Snapshot().PoseOf(id));
  map.closer.AdjustAll(map.made.keyframes.back(), nullptr, AtOnce);
  for (size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(map.store.Snapshot().PoseOf(other.keyframes[i]).t, before[i].t);
  EXPECT_LT(map.Error(), 2e-4);
}

TEST(AdjustAll, OfAKeyFrameThatIsGoneDoesNothing) {
  Unsettled map;
  const KeyFrameId gone = map.made.keyframes[3];
  map.store.Commit([&](MapCommit& commit) { commit.Remove(gone); });
  const uint64_t version = map.store.Snapshot().version();
  map.closer.AdjustAll(gone, nullptr, AtOnce);
  EXPECT_EQ(map.store.Snapshot().version(), version);
}

}  // namespace
}  // namespace alidade::loop_closer_test
