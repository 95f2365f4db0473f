#include "alidade/mapping/mapper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "alidade/base/parallel.h"
#include "alidade/map/map_file.h"
#include "problems/synthetic_world.h"
#include "support/check_map.h"

namespace alidade::mapper_test {
namespace {

constexpr SyntheticWorldSettings kWorld{
    .points = 600, .cameras = 14, .noise_px = 0.7, .flipped_bits = 12, .clutter = 150};

// Correct landmark of each keypoint of a view.
std::vector<LandmarkId> MatchesOf(const SyntheticWorld& world, const MapSnapshot& map,
                                  const SyntheticView& view) {
  std::map<int, LandmarkId> landmark_of;  // by world point
  for (LandmarkId id : map.Landmarks()) {
    const Observation& first = map.Find(id)->observations.front();
    const int number = map.Find(first.keyframe)->frame->number;
    landmark_of[world.views[number].points[first.keypoint]] = id;
  }
  std::vector<LandmarkId> matches;
  for (int point : view.points) {
    matches.push_back(point >= 0 && landmark_of.count(point) ? landmark_of[point] : LandmarkId{});
  }
  return matches;
}

// Median distance of landmarks from the true points of their first observations, meters of the
// world.
double MedianError(const SyntheticWorld& world, const MapSnapshot& map, double scale) {
  std::vector<double> errors;
  for (LandmarkId id : map.Landmarks()) {
    const Observation& first = map.Find(id)->observations.front();
    const int point = world.views[map.Find(first.keyframe)->frame->number].points[first.keypoint];
    errors.push_back(point < 0 ? 1e9
                               : (map.Find(id)->p_world * scale - world.points[point]).norm());
  }
  std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2),
                   errors.end());
  return errors[errors.size() / 2];
}

void MapWithDepth(const SyntheticWorld& world, MapStore& store) {
  Mapper mapper(store, world.camera, {});
  KeyFrameId parent;
  for (const SyntheticView& view : world.views) {
    const auto matches = MatchesOf(world, store.Snapshot(), view);
    const KeyFrameId id = mapper.Insert(
        view.frame, AnchorTo(store.Snapshot().state(), parent, view.T_camera_world), matches);
    mapper.Process(id);
    ExpectConsistent(store.Snapshot());
    parent = id;
  }
}

TEST(Mapper, MapsAWorldSeenWithDepth) {
  SyntheticWorldSettings settings = kWorld;
  settings.depth = true;
  const SyntheticWorld world = MakeSyntheticWorld(settings);
  MapStore store;
  MapWithDepth(world, store);
  const MapSnapshot map = store.Snapshot();
  EXPECT_GT(map.landmark_count(), 300);
  // Half of them are beyond the depth limit and triangulated with little parallax.
  EXPECT_LT(MedianError(world, map, 1), 0.03);
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    const Se3& truth = world.views[keyframe.frame->number].T_camera_world;
    EXPECT_LT((keyframe.Centre() - truth.Inverse().t).norm(), 0.01);
  }
}

// sigma_z / z = z sigma_d / (f b) for a stereo pair, 0.003 z for a depth camera: the same limit
// applies to both.
TEST(Mapper, TrustsDepthAsFarAsTheSensorCanTell) {
  struct Case {
    double focal, baseline, depth_factor, share;
    int level;
    double trusted, too_far;  // metres
  };
  const std::vector<Case> cases = {
      {707, 0.537, 0, 0.08, 0, 75, 77},       // KITTI: 0.08 * 707 * 0.537 / 0.4 = 75.9
      {707, 0.537, 0, 0.08, 4, 36, 37.5},     // larger uncertainty by 1.2^4
      {525, 0.11, 0, 0.08, 0, 11.4, 11.7},    // a hand-held stereo pair
      {525, 0, 5000, 0.08, 0, 26, 27},        // a depth camera; its range is limited by the tracker
      {525, 0, 5000, 0.08, 7, 26, 27},        // whose noise does not depend on the level
      {707, 0.537, 0, 0.02, 0, 18.5, 19.5}};  // a stricter limit
  for (const Case& c : cases) {
    Camera camera;
    camera.width = 640;
    camera.height = 480;
    camera.fx = camera.fy = c.focal;
    camera.baseline = c.baseline;
    camera.depth_factor = c.depth_factor;
    MapperSettings settings;
    settings.max_depth_error = c.share;
    MapStore store;
    const Mapper mapper(store, camera, settings);
    Keypoint keypoint;
    keypoint.level = c.level;
    keypoint.depth = static_cast<float>(c.trusted);
    EXPECT_TRUE(mapper.MakesLandmark(keypoint)) << c.trusted;
    keypoint.depth = static_cast<float>(c.too_far);
    EXPECT_FALSE(mapper.MakesLandmark(keypoint)) << c.too_far;
    keypoint.depth = Keypoint::kNoDepth;
    EXPECT_FALSE(mapper.MakesLandmark(keypoint));
  }
}

TEST(Mapper, GivesTheSameMapWithAnyNumberOfThreads) {
  SyntheticWorldSettings settings = kWorld;
  settings.depth = true;
  const SyntheticWorld world = MakeSyntheticWorld(settings);
  std::vector<std::string> maps;
  for (int threads : {1, 2, 5}) {
    SetThreadCount(threads);
    MapStore store;
    MapWithDepth(world, store);
    maps.push_back(EncodeMap({store.Snapshot(), world.camera, "rgbd", {}, {}, 0}));
  }
  SetThreadCount(0);
  EXPECT_TRUE(maps[0] == maps[1]);
  EXPECT_TRUE(maps[0] == maps[2]);
}

TEST(Mapper, MapsAWorldFromTwoMonocularViewsOn) {
  const SyntheticWorld world = MakeSyntheticWorld(kWorld);
  MapStore store;
  Mapper mapper(store, world.camera, {});
  const SyntheticView &a = world.views[0], &b = world.views[2];
  Mapper::TwoViewMap start;
  start.a = a.frame;
  start.b = b.frame;
  start.T_b_a = b.T_camera_world;  // the first camera is the world frame
  for (size_t i = 0; i < a.points.size(); ++i) {
    const auto j = std::find(b.points.begin(), b.points.end(), a.points[i]);
    if (a.points[i] < 0 || j == b.points.end()) continue;
    start.points.push_back(
        {world.points[a.points[i]], static_cast<int>(i), static_cast<int>(j - b.points.begin())});
  }
  ASSERT_GT(start.points.size(), 80u);
  KeyFrameId parent = mapper.InsertTwoViews(start);
  MapSnapshot map = store.Snapshot();
  ExpectConsistent(map);
  std::vector<double> depths;  // median 1 in map units
  for (LandmarkId id : map.Landmarks()) depths.push_back(map.Find(id)->p_world.z());
  std::nth_element(depths.begin(), depths.begin() + static_cast<long>(depths.size() / 2),
                   depths.end());
  EXPECT_NEAR(depths[depths.size() / 2], 1, 1e-9);
  const double scale = b.T_camera_world.t.norm() / map.Find(parent)->T_camera_world.t.norm();

  const int started_with = map.landmark_count();
  for (size_t v = 3; v < world.views.size(); ++v) {
    Se3 T = world.views[v].T_camera_world;
    T.t /= scale;
    parent = mapper.Insert(world.views[v].frame, AnchorTo(store.Snapshot().state(), parent, T),
                           MatchesOf(world, store.Snapshot(), world.views[v]));
    mapper.Process(parent);
    ExpectConsistent(store.Snapshot());
  }
  map = store.Snapshot();
  EXPECT_GT(map.landmark_count(),
            started_with + 80);                    // most of the 600 points are visible at once
  EXPECT_LT(MedianError(world, map, scale), 0.1);  // 2 % of their distance
}

TEST(Mapper, RemovesLandmarksTheTrackerSeldomFinds) {
  SyntheticWorldSettings settings = kWorld;
  settings.depth = true;
  const SyntheticWorld world = MakeSyntheticWorld(settings);
  MapStore store;
  Mapper mapper(store, world.camera, {});
  const KeyFrameId first = mapper.Insert(world.views[0].frame, {}, {});
  const LandmarkId lost = store.Snapshot().Landmarks()[10];
  for (int i = 0; i < 8; ++i) {
    const std::pair<LandmarkId, bool> sighting{lost, i == 0};
    mapper.Count({&sighting, 1});
  }
  mapper.Process(first);
  EXPECT_EQ(store.Snapshot().Find(lost), nullptr);
}

TEST(Mapper, ProcessingAKeyframeThatIsGoneDoesNothing) {
  MapStore store;
  Mapper mapper(store, Camera::FromFieldOfView(640, 480, 66), {});
  EXPECT_EQ(mapper.Process(KeyFrameId{3}).triangulated, 0);
}

}  // namespace
}  // namespace alidade::mapper_test
