#include "alidade/mapping/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "problems/synthetic_map.h"

namespace alidade::triangulate_test {
namespace {

struct Judgement {
  int right = 0, wrong = 0;
  double worst_error = 0;  // of the correct ones, meters
};

// Correct: both keypoints observe the same world point, and its position error is within
// `tolerance` of its distance.
Judgement Judge(const SyntheticWorld& world, const std::vector<NewLandmark>& made,
                double tolerance) {
  Judgement judgement;
  for (const NewLandmark& landmark : made) {
    const int a = world.views[landmark.first.keyframe.value].points[landmark.first.keypoint];
    const int b = world.views[landmark.second.keyframe.value].points[landmark.second.keypoint];
    const double error =
        a < 0 ? INFINITY : (landmark.p_world - world.points[a]).norm() / world.points[a].norm();
    if (a != b || !(error < tolerance)) {
      ++judgement.wrong;
    } else {
      ++judgement.right;
      judgement.worst_error = std::max(judgement.worst_error, error);
    }
  }
  return judgement;
}

double ParallaxDegrees(const Eigen::Vector3d& p, const Se3& T_a_world, const Se3& T_b_world) {
  const Eigen::Vector3d a = p - T_a_world.Inverse().t, b = p - T_b_world.Inverse().t;
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

// As in the mapper.
std::vector<NewLandmark> Triangulated(const MapSnapshot& map, KeyFrameId id, const Camera& camera,
                                      const MapperSettings& settings = {}) {
  return TriangulateNew(map, id, AtKnownDistance(map, *map.Find(id), camera, settings), camera,
                        settings);
}

TEST(TriangulateNew, FindsTheTruePointsOfAnExactWorld) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 600, .cameras = 6, .clutter = 100});
  MapStore store;
  const SyntheticMap made = FillMap(world, {.known = 0.4}, store);
  const auto landmarks = Triangulated(store.Snapshot(), made.keyframes.back(), world.camera);
  const Judgement judgement =
      Judge(world, landmarks, 1e-3);  // keypoints are floats: 3e-5 px at 20 px of parallax
  EXPECT_EQ(judgement.wrong, 0);

  // All possible ones: not mapped yet and observed from an older keyframe with more than the
  // minimum parallax.
  std::set<int> possible;
  const SyntheticView& last = world.views.back();
  for (size_t v = 0; v + 1 < world.views.size(); ++v) {
    for (int point : world.views[v].points) {
      if (point < 0 || made.landmarks[point].valid()) continue;
      const bool seen =
          std::find(last.points.begin(), last.points.end(), point) != last.points.end();
      if (seen && ParallaxDegrees(world.points[point], last.T_camera_world,
                                  world.views[v].T_camera_world) > 1.1) {
        possible.insert(point);
      }
    }
  }
  ASSERT_GT(possible.size(), 100u);
  EXPECT_GE(judgement.right,
            // A few lie on each other's epipolar lines.
            0.97 * static_cast<double>(possible.size()));
}

TEST(TriangulateNew, MakesNoWrongPointsOfOutlierDescriptors) {
  SyntheticWorld world = MakeSyntheticWorld({.points = 600,
                                             .cameras = 6,
                                             .noise_px = 0.5,
                                             .flipped_bits = 15,
                                             .clutter = 200,
                                             .seed = 4});
  // Every third keypoint of the newest view has a random descriptor.
  Random random(9);
  auto frame = std::make_shared<Frame>(*world.views.back().frame);
  for (size_t i = 0; i < frame->descriptors.size(); i += 3)
    frame->descriptors[i] = RandomDescriptor(random);
  world.views.back().frame = frame;
  MapStore store;
  const SyntheticMap made = FillMap(world, {.known = 0.4}, store);
  const auto landmarks = Triangulated(store.Snapshot(), made.keyframes.back(), world.camera);
  // Half a pixel (more on coarse levels) at a parallax of at least a degree: up to a fifth of the
  // distance.
  const Judgement judgement = Judge(world, landmarks, 0.35);
  EXPECT_EQ(judgement.wrong, 0);
  EXPECT_GT(judgement.right, 50);
}

TEST(TriangulateNew, UsesNoKeypointTwiceAndNoneThatIsKnown) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 500, .cameras = 7, .noise_px = 0.5});
  MapStore store;
  const SyntheticMap made = FillMap(world, {.known = 0.5}, store);
  const MapSnapshot map = store.Snapshot();
  std::set<std::pair<KeyFrameId, int>> used;
  for (const NewLandmark& landmark : Triangulated(map, made.keyframes.back(), world.camera)) {
    EXPECT_EQ(landmark.second.keyframe, made.keyframes.back());
    EXPECT_TRUE(used.insert({landmark.second.keyframe, landmark.second.keypoint}).second);
    for (const Observation& o : {landmark.first, landmark.second}) {
      EXPECT_FALSE(map.Find(o.keyframe)->landmarks[o.keypoint].valid());
    }
  }
  EXPECT_FALSE(used.empty());
}

TEST(TriangulateNew, RefusesWhatHasTooLittleParallax) {
  SyntheticWorldMaker maker({.points = 400});
  for (int i = 0; i < 4; ++i) maker.Look({Eigen::Matrix3d::Identity(), {-0.008 * i, 0, 0}});
  const SyntheticWorld world = maker.Take();
  MapStore store;
  const SyntheticMap made = FillMap(world, {.known = 0.5}, store);
  MapperSettings settings;
  settings.min_parallax_degrees_mono = 1;  // 24 mm at 2.5 m or more: half of that
  settings.min_baseline_ratio = 1e-6;      // so that only the angle decides
  EXPECT_TRUE(
      Triangulated(store.Snapshot(), made.keyframes.back(), world.camera, settings).empty());
}

}  // namespace
}  // namespace alidade::triangulate_test
