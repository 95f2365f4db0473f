#include "alidade/mapping/local_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "problems/synthetic_map.h"
#include "support/check_map.h"

namespace alidade::local_window_test {
namespace {

double Distance(const Se3& a, const Se3& b) { return (a * b.Inverse()).Log().norm(); }

// Over all observations of the adjusted landmarks, pixels.
double RmsReprojection(const MapSnapshot& map, const Camera& camera, const Adjustment& window) {
  double sum = 0;
  int count = 0;
  for (const auto& point : window.points) {
    const LandmarkId id = point.first;
    if (!map.Find(id)) continue;
    for (const Observation& o : map.Find(id)->observations) {
      const KeyFrame& keyframe = *map.Find(o.keyframe);
      const Eigen::Vector2d seen = keyframe.frame->keypoints[o.keypoint].pixel();
      sum += (camera.Project(keyframe.T_camera_world * map.Find(id)->p_world) - seen).squaredNorm();
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

MapperSettings Patient() {
  MapperSettings settings;
  settings.bundle.max_iterations = 60;
  settings.bundle.min_relative_decrease = 1e-9;
  return settings;
}

class WindowTest : public testing::TestWithParam<bool> {  // with depth?
 protected:
  // The first two keyframes are exact, everything else is off by centimeters.
  void Make(const SyntheticMapSettings& settings, double noise_px = 0) {
    world_ = MakeSyntheticWorld(
        {.points = 250, .cameras = 7, .noise_px = noise_px, .depth = GetParam()});
    made_ = FillMap(world_, settings, store_);
  }
  SyntheticWorld world_;
  MapStore store_;
  SyntheticMap made_;
};

TEST_P(WindowTest, ReturnsToTheTruthOfAnExactWorld) {
  Make({.pose_sigma = 0.01, .point_sigma = 0.03});
  const MapSnapshot before = store_.Snapshot();
  const Adjustment result =
      AdjustWindow(before, made_.keyframes.back(), world_.camera, Patient(), nullptr);
  const MapSnapshot after =
      store_.Commit([&](MapCommit& commit) { CommitAdjustment(commit, before, result); });
  EXPECT_GT(RmsReprojection(before, world_.camera, result), 3);
  EXPECT_LT(RmsReprojection(after, world_.camera, result), 0.01);
  for (size_t v = 0; v < world_.views.size(); ++v) {
    EXPECT_LT(Distance(after.PoseOf(made_.keyframes[v]), world_.views[v].T_camera_world), 1e-3)
        << v;
  }
  EXPECT_TRUE(result.outliers.empty());
}

TEST_P(WindowTest, LowersTheErrorAndHoldsTheGauge) {
  Make({.pose_sigma = 0.01, .point_sigma = 0.03}, /*noise_px=*/1);
  MapperSettings settings;
  settings.window_keyframes = 3;  // the other keyframes are fixed
  const MapSnapshot before = store_.Snapshot();
  const Adjustment result =
      AdjustWindow(before, made_.keyframes.back(), world_.camera, settings, nullptr);
  EXPECT_EQ(result.poses.size(), 3u);
  EXPECT_LT(result.report.final_cost, 0.5 * result.report.initial_cost);
  const MapSnapshot after = store_.Commit([&](MapCommit& commit) {
    CommitAdjustment(commit, before, result);
    for (const auto& point : result.points)
      commit.RefreshLandmark(point.first);  // it may have no observations now
  });
  EXPECT_LT(RmsReprojection(after, world_.camera, result),
            RmsReprojection(before, world_.camera, result));
  for (KeyFrameId id : made_.keyframes) {
    const bool adjusted = std::any_of(result.poses.begin(), result.poses.end(),
                                      [&](const auto& p) { return p.first == id; });
    const Se3 &a = before.Find(id)->T_camera_world, &b = after.Find(id)->T_camera_world;
    EXPECT_EQ(a.R != b.R || a.t != b.t, adjusted);
  }
  ExpectConsistent(after);
}

TEST_P(WindowTest, TheFirstKeyframeNeverMoves) {
  Make({.pose_sigma = 0.01, .point_sigma = 0.03}, /*noise_px=*/1);
  for (KeyFrameId id : made_.keyframes) {
    if (id == made_.keyframes.front()) continue;
    const Adjustment result = AdjustWindow(store_.Snapshot(), id, world_.camera, {}, nullptr);
    size_t moved = 0;
    for (const auto& [adjusted, T] : result.poses) {
      EXPECT_NE(adjusted, made_.keyframes.front());
      ++moved;
    }
    // In a monocular map a second fixed keyframe determines the scale.
    EXPECT_LE(moved, made_.keyframes.size() - (GetParam() ? 1 : 2));
  }
}

TEST_P(WindowTest, NamesObservationsThatDoNotFit) {
  Make({}, /*noise_px=*/0.3);
  // One keyframe has the observations of two distant landmarks swapped.
  LandmarkId one, other;
  const KeyFrameId confused = made_.keyframes[4];
  store_.Commit([&](MapCommit& commit) {
    const KeyFrame& keyframe = *commit.Find(confused);
    int a = -1, b = -1;
    for (size_t k = 0; k < keyframe.landmarks.size(); ++k) {
      if (!keyframe.landmarks[k].valid() ||
          commit.Find(keyframe.landmarks[k])->observations.size() < 4)
        continue;
      if (a < 0) a = static_cast<int>(k);
      const Eigen::Vector2d away =
          keyframe.frame->keypoints[k].pixel() - keyframe.frame->keypoints[a].pixel();
      if (away.norm() > 100) b = static_cast<int>(k);
    }
    one = keyframe.landmarks[a];
    other = keyframe.landmarks[b];
    commit.RemoveObservation(one, confused);
    commit.RemoveObservation(other, confused);
    commit.AddObservation(one, confused, b);
    commit.AddObservation(other, confused, a);
  });
  const MapSnapshot before = store_.Snapshot();
  const Adjustment result =
      AdjustWindow(before, made_.keyframes.back(), world_.camera, Patient(), nullptr);
  const auto named = [&](LandmarkId id) {
    return std::count(result.outliers.begin(), result.outliers.end(),
                      std::make_pair(id, confused)) == 1;
  };
  EXPECT_TRUE(named(one));
  EXPECT_TRUE(named(other));
  const MapSnapshot after =
      store_.Commit([&](MapCommit& commit) { CommitAdjustment(commit, before, result); });
  for (const Observation& o : after.Find(one)->observations) EXPECT_NE(o.keyframe, confused);
}

INSTANTIATE_TEST_SUITE_P(Sensors, WindowTest, testing::Bool(), [](const auto& sensor) {
  return sensor.param ? "WithDepth" : "Monocular";
});

TEST(CommitAdjustment, LeavesOutWhatDiedMeanwhile) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 250, .cameras = 6});
  MapStore store;
  const SyntheticMap made = FillMap(world, {.pose_sigma = 0.01, .point_sigma = 0.03}, store);
  const MapSnapshot base = store.Snapshot();
  const Adjustment result = AdjustWindow(base, made.keyframes.back(), world.camera, {}, nullptr);
  const LandmarkId gone = result.points[5].first, fused = result.points[6].first,
                   kept = result.points[7].first;
  store.Commit([&](MapCommit& commit) {
    commit.Remove(gone);
    commit.Replace(fused, kept);
    commit.Remove(made.keyframes[3]);
    for (LandmarkId id : base.Landmarks()) commit.RefreshLandmark(id);
  });
  const MapSnapshot after =
      store.Commit([&](MapCommit& commit) { CommitAdjustment(commit, base, result); });
  EXPECT_EQ(after.Find(gone), nullptr);
  EXPECT_EQ(after.Find(fused), nullptr);
  EXPECT_EQ(after.Find(made.keyframes[3]), nullptr);
  EXPECT_EQ(after.Find(kept)->p_world, result.points[7].second);
}

TEST(CommitAdjustment, TheYoungFollow) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 250, .cameras = 6});
  MapStore store;
  const SyntheticMap made =
      FillMap(world, {.pose_sigma = 0.02, .point_sigma = 0.03, .keyframes = 5}, store);
  const MapSnapshot base = store.Snapshot();
  const KeyFrameId parent = made.keyframes.back();
  const Adjustment result = AdjustWindow(base, parent, world.camera, {}, nullptr);
  // Created meanwhile: a child of the adjusted keyframe, a grandchild, and a landmark in each.
  KeyFrameId child, grandchild;
  LandmarkId in_parent, in_grandchild;
  store.Commit([&](MapCommit& commit) {
    KeyFrame keyframe;
    keyframe.frame = world.views.back().frame;
    keyframe.T_camera_world = world.views.back().T_camera_world;
    keyframe.parent = parent;
    child = commit.Add(keyframe);
    keyframe.parent = child;
    keyframe.T_camera_world.t.x() -= 0.1;
    grandchild = commit.Add(keyframe);
    Landmark landmark;
    landmark.p_world = {0.3, 0.2, 4};
    landmark.reference = landmark.born = parent;
    int free = 0;
    while (commit.Find(parent)->landmarks[free].valid()) ++free;
    landmark.observations = {{parent, free}};
    in_parent = commit.Add(landmark);
    landmark.reference = landmark.born = grandchild;
    landmark.observations = {{grandchild, 0}};
    in_grandchild = commit.Add(landmark);
  });
  const MapSnapshot before = store.Snapshot();
  const MapSnapshot after =
      store.Commit([&](MapCommit& commit) { CommitAdjustment(commit, base, result); });
  ASSERT_GT(Distance(before.PoseOf(parent), after.PoseOf(parent)), 1e-3);
  const auto between = [](const MapSnapshot& map, KeyFrameId a, KeyFrameId b) {
    return map.PoseOf(a) * map.PoseOf(b).Inverse();
  };
  EXPECT_LT(Distance(between(before, child, parent), between(after, child, parent)), 1e-12);
  EXPECT_LT(Distance(between(before, grandchild, parent), between(after, grandchild, parent)),
            1e-12);
  const auto in_camera = [](const MapSnapshot& map, LandmarkId id) {
    return Eigen::Vector3d(map.PoseOf(map.Find(id)->reference) * map.Find(id)->p_world);
  };
  EXPECT_LT((in_camera(before, in_parent) - in_camera(after, in_parent)).norm(), 1e-12);
  EXPECT_LT((in_camera(before, in_grandchild) - in_camera(after, in_grandchild)).norm(), 1e-12);
}

// The adjustment moves its newest keyframe by centimeters, because its pose was wrong. A keyframe
// that was placed by exact landmarks meanwhile does not share that error.
TEST(CommitAdjustment, TheYoungStayWithTheirLandmarks) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 250, .cameras = 6});
  MapStore store;
  const SyntheticMap made = FillMap(world, {.pose_sigma = 0.02, .keyframes = 5}, store);
  const MapSnapshot base = store.Snapshot();
  const KeyFrameId parent = made.keyframes.back();
  const Adjustment result = AdjustWindow(base, parent, world.camera, Patient(), nullptr);
  const SyntheticView& view = world.views.back();
  KeyFrameId young;
  store.Commit([&](MapCommit& commit) {
    KeyFrame keyframe;
    keyframe.frame = view.frame;
    keyframe.T_camera_world = view.T_camera_world;
    keyframe.parent = parent;
    young = commit.Add(keyframe);
    for (size_t k = 0; k < view.points.size(); ++k) {
      const LandmarkId id = view.points[k] < 0 ? LandmarkId{} : made.landmarks[view.points[k]];
      if (id.valid()) commit.AddObservation(id, young, static_cast<int>(k));
    }
  });
  const MapSnapshot after =
      store.Commit([&](MapCommit& commit) { CommitAdjustment(commit, base, result); });
  ASSERT_GT(Distance(base.PoseOf(parent), after.PoseOf(parent)), 5e-3);
  EXPECT_LT(Distance(after.PoseOf(young), view.T_camera_world), 2e-3);
}

// A pure rotation: the newest keyframe shares landmarks with few others.
TEST(AdjustWindow, IsFilledWithNeighboursOfNeighbours) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 1500, .cameras = 24, .ring = 0.5});
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const auto adjusted = [&](int shared) {
    MapperSettings settings;
    settings.window_shared = shared;
    return AdjustWindow(store.Snapshot(), made.keyframes.back(), world.camera, settings, nullptr)
        .poses.size();
  };
  const size_t covisible = store.Snapshot().Find(made.keyframes.back())->covisible.size();
  ASSERT_LT(covisible, 12u);
  EXPECT_LE(adjusted(100000), covisible + 1);
  EXPECT_EQ(adjusted(15), 20u);
}

// Noise is a quarter of the assumed one, and every tenth keypoint has an error below the assumed
// gate: with a loss adapted to the measured noise these have less influence.
TEST(AdjustWindow, LetsGoOfWhatTheNoiseDoesNotExplain) {
  SyntheticWorld world = MakeSyntheticWorld({.points = 400, .cameras = 7, .noise_px = 0.2});
  for (SyntheticView& view : world.views) {
    auto frame = std::make_shared<Frame>(*view.frame);
    for (size_t k = 0; k < frame->keypoints.size(); k += 10) {
      frame->keypoints[k].x += 1.8F * static_cast<float>(ScaleOfLevel(frame->keypoints[k].level));
    }
    view.frame = frame;
  }
  const auto error = [&](double min_noise_ratio) {
    MapStore store;
    const SyntheticMap made = FillMap(world, {}, store);
    MapperSettings settings = Patient();
    settings.min_noise_ratio = min_noise_ratio;
    const Adjustment result =
        AdjustWindow(store.Snapshot(), made.keyframes.back(), world.camera, settings, nullptr);
    double sum = 0;
    for (const auto& [id, T_camera_world] : result.poses) {
      const size_t v =
          std::find(made.keyframes.begin(), made.keyframes.end(), id) - made.keyframes.begin();
      sum += Distance(T_camera_world, world.views[v].T_camera_world);
    }
    return sum;
  };
  EXPECT_LT(error(0.1), 0.6 * error(1));
}

TEST(AdjustWindow, StopsWhenTold) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 250, .cameras = 6});
  MapStore store;
  const SyntheticMap made = FillMap(world, {.pose_sigma = 0.02, .point_sigma = 0.03}, store);
  const std::atomic<bool> stop{true};
  const Adjustment result =
      AdjustWindow(store.Snapshot(), made.keyframes.back(), world.camera, {}, &stop);
  EXPECT_EQ(result.report.iterations, 0);
  EXPECT_EQ(result.report.final_cost, result.report.initial_cost);
}

}  // namespace
}  // namespace alidade::local_window_test
