// Pure rotation with few known landmarks: landmarks with assumed depth, and when they are removed.
#include "alidade/mapping/turn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/map/view.h"
#include "alidade/mapping/local_window.h"
#include "alidade/mapping/mapper.h"
#include "problems/synthetic_map.h"

namespace alidade::turn_test {
namespace {

// Views rotated by 1.5° each, and translated by `step` meters to the right.
SyntheticWorld Turning(int views, double noise_px, double step = 0) {
  SyntheticWorldMaker maker({.points = 600, .noise_px = noise_px});
  for (int i = 0; i < views; ++i)
    maker.Look(Se3{ExpSo3({0, 0.026 * i, 0}), {step * i, 0, 0}}.Inverse());
  return maker.Take();
}

TEST(MapTurn, MapsWhatTwoViewsFromOnePlaceShare) {
  const SyntheticWorld world = Turning(5, 0.5);
  MapStore store;
  const SyntheticMap made = FillMap(world, {.known = 0.08}, store);
  const MapSnapshot map = store.Snapshot();
  const KeyFrame& last = *map.Find(made.keyframes.back());
  const double depth = *MedianDepth(map, last);
  const std::vector<NewLandmark> turned = MapTurn(map, last.id, {}, world.camera, {});
  EXPECT_GT(turned.size(), 150u);
  std::set<int> used;
  for (const NewLandmark& landmark : turned) {
    EXPECT_TRUE(landmark.depth_assumed && !landmark.scale_known);
    EXPECT_EQ(landmark.second.keyframe, last.id);
    EXPECT_TRUE(used.insert(landmark.second.keypoint).second);
    EXPECT_EQ(world.views[landmark.first.keyframe.value].points[landmark.first.keypoint],
              world.views.back().points[landmark.second.keypoint]);
    EXPECT_NEAR((last.T_camera_world * landmark.p_world).z(), depth, 1e-9);
    for (const Observation& o : {landmark.first, landmark.second})
      EXPECT_FALSE(map.Find(o.keyframe)->landmarks[o.keypoint].valid());
  }
  // Keypoints that were triangulated are skipped.
  const std::vector<NewLandmark> half(turned.begin(), turned.begin() + 50);
  for (const NewLandmark& landmark : MapTurn(map, last.id, half, world.camera, {})) {
    for (const NewLandmark& taken : half)
      EXPECT_NE(landmark.second.keypoint, taken.second.keypoint);
  }
}

TEST(MapTurn, LeavesAloneWhatIsWellKnownAndWhatCanBeTriangulated) {
  MapperSettings settings;
  {
    const SyntheticWorld world = Turning(5, 0.5);
    MapStore store;
    const SyntheticMap made = FillMap(world, {.known = 0.8}, store);
    EXPECT_TRUE(
        MapTurn(store.Snapshot(), made.keyframes.back(), {}, world.camera, settings).empty());
    settings.rotation_landmarks = 1000;
    EXPECT_FALSE(
        MapTurn(store.Snapshot(), made.keyframes.back(), {}, world.camera, settings).empty());
  }
  const SyntheticWorld world = Turning(5, 0.5, 0.1);  // 2 % of the depth
  MapStore store;
  const SyntheticMap made = FillMap(world, {.known = 0.08}, store);
  EXPECT_TRUE(MapTurn(store.Snapshot(), made.keyframes.back(), {}, world.camera, settings).empty());
}

// Ratio of the standard deviations of log depth and of true log depth in the first view, after an
// adjustment.
double WanderOf(double assumed_depth_error) {
  const SyntheticWorld world = Turning(6, 0.5);
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  MapSnapshot map = store.Commit([&](MapCommit& commit) {
    for (LandmarkId id : made.landmarks) {
      if (id.valid()) commit.Edit(id)->depth_assumed = true;
    }
  });
  MapperSettings settings;
  settings.assumed_depth_error = assumed_depth_error;
  const Adjustment adjusted =
      AdjustWindow(map, made.keyframes.back(), world.camera, settings, nullptr);
  std::vector<double> off;
  for (const auto& [id, p_world] : adjusted.points)
    off.push_back(std::log(p_world.norm() / map.Find(id)->p_world.norm()));
  double mean = 0, square = 0;
  for (double x : off) mean += x / static_cast<double>(off.size());
  for (double x : off) square += (x - mean) * (x - mean) / static_cast<double>(off.size());
  return std::sqrt(square);
}

TEST(AdjustWindow, LetsNoDepthWanderThatNothingTells) {
  EXPECT_LT(WanderOf(0.5), 0.05);
  EXPECT_GT(WanderOf(0), 0.3);
}

// A camera that looks outwards from a ring, rotated by 12° per view; only the landmarks of the
// views in `knowing` have a known scale. Returns which keyframes are split off after mapping the
// last one. `meters`: an inertial sensor has measured the motions between the views, in a map whose
// lengths are meters or not.
std::vector<bool> SplitOff(double radius, int cameras, const std::set<int>& knowing,
                           std::optional<bool> meters = {}) {
  const SyntheticWorld world =
      MakeSyntheticWorld({.points = 2500, .cameras = cameras, .ring = radius, .lap = 30});
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  store.Commit([&](MapCommit& commit) {
    for (LandmarkId id : made.landmarks) {
      if (!id.valid()) continue;
      const auto& seen = commit.Find(id)->observations;
      const bool unknown = std::any_of(seen.begin(), seen.end(), [&](const Observation& o) {
        const auto at = std::find(made.keyframes.begin(), made.keyframes.end(), o.keyframe);
        return !knowing.contains(static_cast<int>(at - made.keyframes.begin()));
      });
      if (unknown) commit.Edit(id)->scale_known = false;
    }
    if (!meters) return;
    commit.SetWorld({MapId{0}, *meters, 0.01, {0, 1, 0}, 0.002});
    for (size_t i = 1; i < made.keyframes.size(); ++i) {
      auto motion = std::make_shared<KeyFrameMotion>();
      motion->since = made.keyframes[i - 1];
      motion->motion.seconds = 1.0 / 30;
      motion->motion.covariance = 1e6 * Matrix9d::Identity();  // it does not move the poses
      motion->accel_bias_sigma = motion->accel_walk = 1;
      commit.Edit(made.keyframes[i])->motion = std::move(motion);
    }
  });
  MapperSettings settings;
  settings.max_unknown_scale_seconds = 0.1;  // 3 frames
  Mapper mapper(store, world.camera, settings);
  const MapperReport report = mapper.Process(made.keyframes.back());
  const MapSnapshot map = store.Snapshot();
  std::vector<bool> split;
  for (KeyFrameId id : made.keyframes)
    split.push_back(map.Find(id) && report.split.valid() && map.MapOf(id) == report.split);
  return split;
}

TEST(Mapper, GivesUpWhatWasMappedAwayFromTheKnownWithoutAScale) {
  const std::vector<bool> split = SplitOff(0.4, 14, {0, 1, 2, 3});
  EXPECT_TRUE(split.back());
  // Keyframes before the camera moved far enough stay.
  for (size_t i = 0; i < 5; ++i) EXPECT_FALSE(split[i]) << i;
}

TEST(Mapper, GivesUpNothingThatIsKnown) {
  const std::vector<bool> split = SplitOff(0.4, 20, {0, 1, 2, 3, 8, 9, 10, 11, 12, 13, 14});
  EXPECT_TRUE(split.back());
  for (size_t i = 0; i < 13; ++i) EXPECT_FALSE(split[i]) << i;
}

TEST(Mapper, KeepsWhatAnInertialSensorMeasures) {
  const std::vector<bool> split = SplitOff(0.4, 14, {0, 1, 2, 3}, true);
  EXPECT_EQ(std::count(split.begin(), split.end(), true), 0);
  EXPECT_TRUE(SplitOff(0.4, 14, {0, 1, 2, 3}, false).back());  // not in meters
}

TEST(Mapper, KeepsWhatWasMappedOnTheSpotWithoutAScale) {
  const std::vector<bool> split = SplitOff(0.05, 14, {0, 1, 2, 3});
  EXPECT_EQ(std::count(split.begin(), split.end(), true), 0);
}

}  // namespace
}  // namespace alidade::turn_test
