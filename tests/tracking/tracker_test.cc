#include "alidade/tracking/tracker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "problems/synthetic_map.h"

namespace alidade::tracker_test {
namespace {

double Metres(const Se3& a, const Se3& b) { return (a.Inverse().t - b.Inverse().t).norm(); }

class TrackerTest : public testing::TestWithParam<bool> {  // with depth?
 protected:
  // The first eight views are keyframes, the others are frames to track.
  static constexpr int kKeyFrames = 8;

  void SetUp() override {
    settings_ = {.points = 900,
                 .cameras = 12,
                 .step = 0.06,
                 .turn = 0.003,
                 .noise_px = 0.5,
                 .flipped_bits = 12,
                 .clutter = 150,
                 .depth = GetParam()};
    world_ = MakeSyntheticWorld(settings_);
    made_ = FillMap(world_, {.keyframes = kKeyFrames}, store_);
  }

  // View `v` with its true pose and matches.
  PlacedFrame Placed(int v) const {
    PlacedFrame placed;
    placed.frame = world_.views[v].frame;
    placed.T_camera_world = world_.views[v].T_camera_world;
    for (int point : world_.views[v].points) {
      placed.matches.push_back(point < 0 ? LandmarkId{} : made_.landmarks[point]);
    }
    return placed;
  }

  void ExpectAtTruth(const TrackEstimate& estimate, int v) const {
    ASSERT_TRUE(estimate.tracked);
    // Hundreds of matches with half a pixel of noise at 5 m give some tenths of a millimeter; a few
    // millimeters are allowed.
    EXPECT_LT(Metres(estimate.placed.T_camera_world, world_.views[v].T_camera_world), 0.005);
    EXPECT_LT(RotationAngle(estimate.placed.T_camera_world, world_.views[v].T_camera_world), 0.001);
    int right = 0, wrong = 0;
    for (size_t k = 0; k < estimate.placed.matches.size(); ++k) {
      if (!estimate.placed.matches[k].valid()) continue;
      const int point = world_.views[v].points[k];
      const bool same = point >= 0 && made_.landmarks[point] == estimate.placed.matches[k];
      ++(same ? right : wrong);
    }
    EXPECT_GT(right, 150);
    EXPECT_LE(wrong, 0.01 * right);
    EXPECT_EQ(right + wrong, estimate.placed.inliers);
  }

  SyntheticWorldSettings settings_;
  SyntheticWorld world_;
  MapStore store_;
  SyntheticMap made_;
};

TEST_P(TrackerTest, FollowsFrameByFrame) {
  const MapSnapshot map = store_.Snapshot();
  Tracker tracker(world_.camera, {});
  tracker.Remember(Placed(kKeyFrames - 1), made_.keyframes.back(), map);
  for (int v = kKeyFrames; v < settings_.cameras; ++v) {
    const TrackEstimate estimate =
        tracker.Estimate(tracker.Predict(world_.views[v].frame, map), map);
    ExpectAtTruth(estimate, v);
    EXPECT_EQ(estimate.reference, made_.keyframes.back());
    tracker.Remember(estimate.placed, estimate.reference, map);
  }
}

TEST_P(TrackerTest, ReturnsToTheTruthFromAGuessThatIsOff) {
  const MapSnapshot map = store_.Snapshot();
  Tracker tracker(world_.camera, {});
  const int v = kKeyFrames;
  PlacedFrame guess = Placed(v);
  // A third of the landmarks is matched; the pose error is about 2 px.
  for (size_t k = 0; k < guess.matches.size(); ++k) {
    if (k % 3 != 0) guess.matches[k] = {};
    guess.inliers += guess.matches[k].valid();
  }
  guess.T_camera_world =
      Se3::Exp((Vector6d() << 0.01, -0.005, 0.01, 0.002, -0.003, 0.002).finished()) *
      guess.T_camera_world;
  ExpectAtTruth(tracker.Estimate(std::move(guess), map), v);
}

TEST_P(TrackerTest, PredictsWithTheSpeedOfTheLastFrames) {
  const MapSnapshot map = store_.Snapshot();
  Tracker tracker(world_.camera, {});
  tracker.Remember(Placed(5), made_.keyframes[5], map);
  tracker.Remember(Placed(6), made_.keyframes[6], map);
  const PlacedFrame guess = tracker.Predict(world_.views[7].frame, map);
  EXPECT_LT(Metres(guess.T_camera_world, world_.views[7].T_camera_world), 0.01);
  EXPECT_GT(guess.inliers, 100);
}

TEST_P(TrackerTest, TheLastFrameFollowsItsKeyframeWhenTheMapIsAdjusted) {
  Tracker tracker(world_.camera, {});
  tracker.Remember(Placed(6), made_.keyframes[6], store_.Snapshot());
  // The whole map moves, as after a loop closure.
  const Se3 T_new_old = Se3::Exp((Vector6d() << 1, 2, -1, 0.3, -0.5, 0.2).finished());
  const MapSnapshot moved = store_.Commit([&](MapCommit& commit) {
    for (KeyFrameId id : made_.keyframes) {
      commit.Edit(id)->T_camera_world = commit.Find(id)->T_camera_world * T_new_old.Inverse();
    }
    for (LandmarkId id : made_.landmarks) {
      if (!commit.Find(id)) continue;
      commit.Edit(id)->p_world = T_new_old * commit.Find(id)->p_world;
      commit.RefreshLandmark(id);
    }
  });
  const TrackEstimate estimate =
      tracker.Estimate(tracker.Predict(world_.views[7].frame, moved), moved);
  ASSERT_TRUE(estimate.tracked);
  EXPECT_LT(
      Metres(estimate.placed.T_camera_world, world_.views[7].T_camera_world * T_new_old.Inverse()),
      0.005);
}

TEST_P(TrackerTest, FindsItsWayAfterASuddenJump) {
  const MapSnapshot map = store_.Snapshot();
  Tracker tracker(world_.camera, {});
  tracker.Remember(Placed(1), made_.keyframes[3], map);  // the prediction is off by 0.5 m
  const TrackEstimate estimate = tracker.Estimate(tracker.Predict(world_.views[9].frame, map), map);
  ExpectAtTruth(estimate, 9);
}

TEST_P(TrackerTest, RelocalisesWithoutALastFrame) {
  const MapSnapshot map = store_.Snapshot();
  Tracker tracker(world_.camera, {});
  tracker.Remember(Placed(4), made_.keyframes[4], map);
  tracker.Forget();
  const TrackEstimate estimate =
      tracker.Relocalise(world_.views[9].frame, map, {{made_.keyframes[4]}});
  ExpectAtTruth(estimate, 9);
}

// Even with many matches, the pose would be too uncertain.
TEST_P(TrackerTest, DoesNotRelocaliseByOnePosterAlone) {
  const SyntheticView& view = world_.views[9];
  const MapSnapshot map = store_.Commit([&](MapCommit& commit) {
    for (size_t k = 0; k < view.points.size(); ++k) {
      if (view.points[k] < 0) continue;
      const Eigen::Vector2d from_poster =
          view.frame->keypoints[k].pixel() - Eigen::Vector2d(250, 200);
      if (from_poster.norm() > 100) commit.Remove(made_.landmarks[view.points[k]]);
    }
  });
  TrackerSettings settings;
  EXPECT_FALSE(
      Tracker(world_.camera, settings).Relocalise(view.frame, map, made_.keyframes).tracked);
  settings.min_relocalized_spread = 0;
  EXPECT_TRUE(
      Tracker(world_.camera, settings).Relocalise(view.frame, map, made_.keyframes).tracked);
}

TEST_P(TrackerTest, IsLostInAnotherWorld) {
  SyntheticWorldSettings elsewhere = settings_;
  elsewhere.seed = 99;
  elsewhere.cameras = 1;
  const SyntheticWorld other = MakeSyntheticWorld(elsewhere);
  const MapSnapshot map = store_.Snapshot();
  Tracker tracker(world_.camera, {});
  tracker.Remember(Placed(kKeyFrames - 1), made_.keyframes.back(), map);
  const TrackEstimate predicted = tracker.Estimate(tracker.Predict(other.views[0].frame, map), map);
  EXPECT_FALSE(predicted.tracked);
  EXPECT_FALSE(predicted.wants_keyframe);
  EXPECT_FALSE(tracker.Relocalise(other.views[0].frame, map, made_.keyframes).tracked);
}

TEST_P(TrackerTest, TellsWhichLandmarksWereFoundOfThoseExpected) {
  const MapSnapshot map = store_.Snapshot();
  Tracker tracker(world_.camera, {});
  tracker.Remember(Placed(kKeyFrames - 1), made_.keyframes.back(), map);
  const TrackEstimate estimate =
      tracker.Estimate(tracker.Predict(world_.views[kKeyFrames].frame, map), map);
  std::vector<int> times(map.next_landmark(), 0);
  int found = 0;
  for (const SightingCount& s : estimate.sightings) {
    EXPECT_EQ(++times[s.landmark.value], 1);
    found += s.found;
  }
  EXPECT_EQ(found, estimate.placed.inliers);
  EXPECT_GT(found, 0.7 * static_cast<double>(
                             estimate.sightings.size()));  // there is no occlusion in this world
}

TEST_P(TrackerTest, AsksForAKeyframeWhenItLeavesWhatTheReferenceSees) {
  const MapSnapshot map = store_.Snapshot();
  Tracker tracker(world_.camera, {});
  // At the newest keyframe: nothing new to observe.
  tracker.KeyFrameInserted(kKeyFrames - 1);
  tracker.Remember(Placed(kKeyFrames - 1), made_.keyframes.back(), map);
  SyntheticWorldMaker same(settings_);
  Frame again = *same.Look(world_.views[kKeyFrames - 1].T_camera_world).frame;
  again.number = kKeyFrames;
  EXPECT_FALSE(
      tracker.Estimate(tracker.Predict(std::make_shared<Frame>(again), map), map).wants_keyframe);
  // Far to the side: half of the landmarks are out of view.
  SyntheticWorldMaker aside(settings_);
  PlacedFrame guess;
  guess.T_camera_world = PoseOnPath(settings_, 30);
  const SyntheticView& seen = aside.Look(guess.T_camera_world);
  Frame far = *seen.frame;
  far.number = kKeyFrames + 20;
  guess.frame = std::make_shared<Frame>(far);
  for (int point : seen.points) {
    guess.matches.push_back(point < 0 ? LandmarkId{} : made_.landmarks[point]);
    guess.inliers += guess.matches.back().valid();
  }
  const TrackEstimate estimate = tracker.Estimate(std::move(guess), map);
  ASSERT_TRUE(estimate.tracked);
  EXPECT_TRUE(estimate.wants_keyframe);
}

INSTANTIATE_TEST_SUITE_P(Sensors, TrackerTest, testing::Bool(), [](const auto& sensor) {
  return sensor.param ? "WithDepth" : "Monocular";
});

}  // namespace
}  // namespace alidade::tracker_test
