#include "alidade/calibration/lens_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "alidade/base/random.h"
#include "support/expect_error.h"
#include "support/vga_camera.h"

namespace alidade::lens_check_test {
namespace {

struct Walk {
  int keyframes = 30;
  double k1 = 0;        // k1 of the lens that the camera model does not include
  int bent_from = 0;    // first keyframe with k1
  double opposite = 0;  // k1 of the keyframes before
  uint64_t seed = 1;
};

// Keyframes along a path past points, each of which is observed for a while.
MapSnapshot MapOf(const Walk& walk) {
  Camera lens = MakeVgaCamera();
  Random random(walk.seed);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 40 * walk.keyframes; ++i) {
    const double z = random.Uniform(2, 5), y = random.Uniform(-1.5, 1.5);
    points.emplace_back(random.Uniform(-2, 0.15 * walk.keyframes + 2), y, z);
  }
  std::vector<std::vector<Observation>> seen(points.size());
  MapStore store;
  store.Commit([&](MapCommit& commit) {
    KeyFrameId parent;
    for (int k = 0; k < walk.keyframes; ++k) {
      const Eigen::Vector3d centre(0.15 * k, 0.1 * std::sin(k), 0.2 * std::cos(0.7 * k));
      const Eigen::Matrix3d R =
          ExpSo3(Eigen::Vector3d(0.1 * std::sin(0.9 * k), 0.2 * std::cos(k), 0));
      KeyFrame keyframe;
      keyframe.parent = parent;
      keyframe.T_camera_world = {R, -(R * centre)};
      auto frame = std::make_shared<Frame>();
      frame->number = k;
      lens.distortion = {k < walk.bent_from ? walk.opposite : walk.k1, 0, 0, 0, 0};
      for (size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d p = keyframe.T_camera_world * points[i];
        if (p.z() < 0.5) continue;
        const Eigen::Vector2d pixel = lens.Distort(lens.Project(p));
        if (!(pixel.x() > 0 && pixel.y() > 0 && pixel.x() < 639 && pixel.y() < 479)) continue;
        Keypoint keypoint;
        keypoint.x = static_cast<float>(pixel.x() + 0.7 * random.Gaussian());
        keypoint.y = static_cast<float>(pixel.y() + 0.7 * random.Gaussian());
        seen[i].push_back(
            {KeyFrameId{static_cast<uint32_t>(k)}, static_cast<int>(frame->keypoints.size())});
        frame->keypoints.push_back(keypoint);
      }
      frame->descriptors.resize(frame->keypoints.size());
      keyframe.frame = std::move(frame);
      parent = commit.Add(std::move(keyframe));
    }
    for (size_t i = 0; i < points.size(); ++i) {
      if (seen[i].size() < 3) continue;
      Landmark landmark;
      landmark.p_world = points[i];
      landmark.observations = seen[i];
      landmark.reference = landmark.born = seen[i].front().keyframe;
      commit.Add(std::move(landmark));
    }
  });
  return store.Snapshot();
}

LensCheck CheckOf(const Walk& walk, const LensCheckSettings& settings = {}) {
  const MapSnapshot map = MapOf(walk);
  return CheckLens(map, MapId{0}, MakeVgaCamera(), {}, settings);
}

TEST(CheckLens, TellsALensThatBendsStrongly) {
  for (double k1 : {-0.25, 0.2}) {
    const LensCheck check = CheckOf({.k1 = k1});
    EXPECT_EQ(check.windows, 3);
    EXPECT_NEAR(check.k1, k1, 0.05);
    EXPECT_NEAR(check.bend, check.k1 * 0.5805, 1e-3);  // the corner is at 0.762 from the axis
    EXPECT_TRUE(check.strong);
  }
}

TEST(CheckLens, BelievesAGoodCameraWhateverTheNoise) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const LensCheck check = CheckOf({.seed = seed});
    EXPECT_LT(std::abs(check.bend), 0.02);
    EXPECT_FALSE(check.strong);
  }
}

TEST(CheckLens, DoesNotMindALittle) { EXPECT_FALSE(CheckOf({.k1 = -0.05}).strong); }

TEST(CheckLens, SaysNothingWherePartsOfTheMapDisagree) {
  const LensCheck check = CheckOf({.k1 = -0.2, .bent_from = 15, .opposite = 0.2});
  EXPECT_GT(check.windows, 0);
  EXPECT_FALSE(check.strong);
}

TEST(CheckLens, SaysNothingOfAFewKeyframes) {
  EXPECT_EQ(CheckOf({.keyframes = 11, .k1 = -0.25}).windows, 0);
  EXPECT_TRUE(CheckOf({.keyframes = 18, .k1 = -0.25}).strong);
  EXPECT_EQ(CheckLens(MapSnapshot(), MapId{0}, MakeVgaCamera(), {}).windows, 0);
}

TEST(CheckLens, LooksAtAFewPartsOfALargeMap) {
  EXPECT_EQ(CheckOf({.keyframes = 60, .k1 = -0.25}, {.max_windows = 4}).windows, 4);
}

TEST(CheckLens, RefusesSettingsThatCannotBe) {
  EXPECT_THAT(ComplaintAbout(LensCheckSettings{.window = 3}), testing::HasSubstr("lens.window"));
  EXPECT_THAT(ComplaintAbout(LensCheckSettings{.min_seen = 1}),
              testing::HasSubstr("lens.min_seen"));
  EXPECT_EQ(ComplaintAbout(LensCheckSettings{}), "");
}

}  // namespace
}  // namespace alidade::lens_check_test
