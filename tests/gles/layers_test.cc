// Each layer of the map is drawn where an independent projection expects it, and no other pixel is
// lit.
#include <gtest/gtest.h>

#include "alidade/base/random.h"
#include "alidade/gles/renderer.h"
#include "gles/expected.h"
#include "gles/told_scene.h"

namespace alidade::gles_test::layers_test {
namespace {

using gles::Renderer;
using gles::ViewSettings;

constexpr int kWidth = 320, kHeight = 240;

Camera Pinhole() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 520;
  camera.fy = 515;
  camera.cx = 322;
  camera.cy = 236;
  return camera;
}

Se3 Pose(double x, double y, double z, double rx = 0, double ry = 0, double rz = 0) {
  return {ExpSo3({rx, ry, rz}), {x, y, z}};
}

Eigen::Vector3d Within(Random& random, double side, double near, double far) {
  const double x = random.Uniform(-side, side);
  const double y = random.Uniform(-side, side);
  return {x, y, random.Uniform(near, far)};
}

// Draws a single layer with thin lines and small points, seen from the side.
ViewSettings Only(bool ViewSettings::*layer) {
  ViewSettings view;
  view.landmarks = view.points = view.path = view.keyframes = view.camera = false;
  view.*layer = true;
  view.picture = {0, 0, 0, 0};
  view.landmark_size = view.point_size = 1;
  view.T_world_eye = Pose(0.4, -0.7, -3, -0.15, -0.08, 0.2);
  return view;
}

class Layers : public GlTest {
 protected:
  Shot Draw(const StreamScene& scene, const ViewSettings& view) {
    const GlScreen screen(kWidth, kHeight);
    Renderer renderer;
    renderer.Resize(kWidth, kHeight);
    renderer.Show(scene);
    renderer.Draw(view);
    const Shot shot = screen.Take();
    renderer.Release();
    return shot;
  }
};

TEST_F(Layers, LandmarksAreWhereTheirKeyframesHaveThem) {
  Random random(7);
  Teller teller(Pinhole());
  Change change;
  change.keyframes = {{3, 0, Pose(0, 0, 0), 1}, {9, 0, Pose(0.5, 0.1, -0.3, 0.1, 0.3, -0.2), 0.6}};
  std::vector<Eigen::Vector3d> points;
  for (uint32_t i = 0; i < 300; ++i) {
    const Change::NewKeyFrame& k = change.keyframes[i % 2];
    const Eigen::Vector3f p = Within(random, 1.5, 1, 4).cast<float>();
    change.landmarks.push_back({i, k.id, p});
    points.push_back(k.T_world_camera * (k.scale * p.cast<double>()));
  }
  teller.Tell(change);
  const ViewSettings view = Only(&ViewSettings::landmarks);
  const Shot shot = Draw(teller.scene, view);
  ExpectPoints(shot, view, points);
  const Pixel ink = PixelOf(view.colors.landmarks);
  EXPECT_TRUE(std::all_of(shot.pixels.begin(), shot.pixels.end(), [&](const Pixel& pixel) {
    return pixel == PixelOf(view.colors.background) || Difference(pixel, ink) <= 1;
  }));

  // The keyframe moves and changes its scale: its landmarks follow, although they are not sent
  // again.
  Change moved;
  moved.moves = {{9, 0, Pose(-0.4, 0.2, 0.1, 0, -0.3, 0.1), 0.8}};
  teller.Tell(moved);
  for (size_t i = 1; i < points.size(); i += 2) {
    points[i] = moved.moves[0].T_world_camera * (0.8 * change.landmarks[i].p.cast<double>());
  }
  ExpectPoints(Draw(teller.scene, view), view, points);
}

TEST_F(Layers, SemiDensePointsHaveTheirPlacesAndColours) {
  Random random(3);
  const Camera camera = Pinhole();
  Teller teller(camera);
  Change change;
  change.keyframes = {{0, 0, Pose(0, 0, 0), 1}, {1, 0, Pose(0.3, 0, 0.2, 0, 0.2, 0.1), 1.7}};
  for (uint32_t k = 0; k < 2; ++k) {
    std::vector<ToldPoint> told;
    for (int i = 0; i < 400; ++i) {  // at whole pixels, as in depth maps
      const double x = random.Below(640), y = random.Below(480);
      ToldPoint point;
      point.p = camera.Unproject({x, y}, random.Uniform(0.8, 6));
      point.red = static_cast<int>(random.Below(256));
      point.green = static_cast<int>(random.Below(256));
      point.blue = 255;  // distinguishes points from the dark background
      told.push_back(point);
    }
    change.clouds.push_back({k, told});
  }
  teller.Tell(change);
  const ViewSettings view = Only(&ViewSettings::points);
  const Shot shot = Draw(teller.scene, view);
  std::vector<Eigen::Vector3d> points;
  const Lens lens(view, kWidth, kHeight);
  int compared = 0, wrong = 0;
  for (const Change::NewCloud& cloud : change.clouds) {
    const std::vector<Eigen::Vector3d> kept = KeptPoints(teller.scene, cloud.keyframe);
    ASSERT_EQ(kept.size(), cloud.points.size());
    const Change::NewKeyFrame& k = change.keyframes[cloud.keyframe];
    for (size_t i = 0; i < kept.size(); ++i) {
      const ToldPoint& point = cloud.points[i];
      const Eigen::Vector3d truth = k.T_world_camera * (k.scale * point.p);
      ASSERT_LT((kept[i] - truth).norm(), 2e-4 * k.scale * point.p.norm());
      points.push_back(kept[i]);
      const auto at = lens.See(kept[i]);
      if (!at) continue;
      ++compared;
      const Pixel told{static_cast<uint8_t>(point.red), static_cast<uint8_t>(point.green), 255,
                       255};
      wrong += Difference(shot.At(static_cast<int>(at->x()), static_cast<int>(at->y())), told) > 9;
    }
  }
  ExpectPoints(shot, view, points);
  EXPECT_GT(compared, 300);
  EXPECT_LE(wrong, compared / 20);  // occluded by others, or off by one pixel
}

// Frames are anchored to keyframes of different scales; the path is interrupted where the camera
// was lost or another map began.
TEST_F(Layers, ThePathGoesFromFrameToFrame) {
  Teller teller(Pinhole());
  Change change;
  const Se3 second = Pose(0.8, 0, 0.2, 0, 0.4, 0);
  change.keyframes = {{0, 0, Pose(0, 0, 0), 1}, {1, 0, second, 0.5}, {2, 1, Pose(0, 0, 0), 1}};
  teller.Tell(change);
  teller.TellFrame(2, Pose(0.1, 0.1, 0));  // in another map
  teller.TellFrame(2, Pose(0.9, 0.9, 0));
  const std::vector<Eigen::Vector3d> first = {{0, 0, 0}, {0.2, 0.3, 0}, {0.5, 0.1, 0.2}};
  for (const Eigen::Vector3d& t : first) teller.TellFrame(0, {Eigen::Matrix3d::Identity(), t});
  teller.TellFrame(1, Pose(0.2, 0.4, 0));
  teller.TellFrame(KeyFrameId::kNone, {});
  teller.TellFrame(1, Pose(-0.8, -0.4, 0));
  teller.TellFrame(1, Pose(-0.4, -0.8, 0.2));
  ViewSettings view = Only(&ViewSettings::path);
  view.line_width = 1.5;
  const std::vector<Segment> segments = {
      {first[0], first[1]},
      {first[1], first[2]},
      {first[2], second * Eigen::Vector3d(0.1, 0.2, 0)},
      {second * Eigen::Vector3d(-0.4, -0.2, 0), second * Eigen::Vector3d(-0.2, -0.4, 0.1)}};
  ExpectSegments(Draw(teller.scene, view), view, segments);
}

std::vector<Segment> FrustumOf(const Camera& camera, const Se3& T_world_camera, double deep) {
  std::vector<Segment> segments;
  const Eigen::Vector2d ends[] = {{-0.5, -0.5}, {639.5, -0.5}, {639.5, 479.5}, {-0.5, 479.5}};
  for (size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d corner = T_world_camera * camera.Unproject(ends[k], deep);
    segments.push_back({T_world_camera.t, corner});
    segments.push_back({corner, T_world_camera * camera.Unproject(ends[(k + 1) % 4], deep)});
  }
  return segments;
}

TEST_F(Layers, KeyframesAreFrustaOfOneSizeWhateverTheirScale) {
  Teller teller(Pinhole());
  Change change;
  change.keyframes = {{0, 0, Pose(0, 0, 0, 0.1, 0.5, 0), 1},
                      {1, 0, Pose(0.7, 0.2, 0.4, 0, -0.5, 0), 3}};
  teller.Tell(change);
  ViewSettings view = Only(&ViewSettings::keyframes);
  view.frustum = 0.4;
  std::vector<Segment> segments = FrustumOf(Pinhole(), change.keyframes[0].T_world_camera, 0.4);
  const std::vector<Segment> second = FrustumOf(Pinhole(), change.keyframes[1].T_world_camera, 0.4);
  segments.insert(segments.end(), second.begin(), second.end());
  ExpectSegments(Draw(teller.scene, view), view, segments);
}

TEST_F(Layers, TheCameraIsWhereTheMapNowHasItOrWhereItsMotionLeads) {
  Teller teller(Pinhole());
  Change change;
  change.keyframes = {{0, 0, Pose(0, 0, 0), 2}};
  teller.Tell(change);
  ViewSettings view = Only(&ViewSettings::camera);
  view.frustum = 0.2;
  EXPECT_EQ(CountLit(Draw(teller.scene, view), view), 0);  // no frame yet
  teller.TellFrame(0, Pose(0.1, 0.2, 0, 0, 0.3, 0));
  Change moved;
  moved.moves = {{0, 0, Pose(0.3, 0, 0), 1.5}};
  teller.Tell(moved);
  const Shot tracked = Draw(teller.scene, view);
  ExpectSegments(tracked, view, FrustumOf(Pinhole(), Pose(0.45, 0.3, 0, 0, 0.3, 0), 0.4));
  const auto has = [](const Shot& shot, const gles::Color& color) {
    return std::count(shot.pixels.begin(), shot.pixels.end(), PixelOf(color)) > 0;
  };
  EXPECT_TRUE(has(tracked, view.colors.tracked));

  const Se3 guess = Pose(-0.2, 0.1, 0.1);
  teller.TellFrame(KeyFrameId::kNone, {}, {}, &guess);
  const Shot lost = Draw(teller.scene, view);
  ExpectSegments(lost, view, FrustumOf(Pinhole(), guess, 0.4));
  EXPECT_TRUE(has(lost, view.colors.lost));
  teller.TellFrame(KeyFrameId::kNone, {});
  EXPECT_EQ(CountLit(Draw(teller.scene, view), view), 0);  // permanently lost
}

TEST_F(Layers, OtherMapsAreFaintOrHidden) {
  Teller teller(Pinhole());
  Change change;
  change.keyframes = {{0, 0, Pose(0, 0, 0), 1}, {1, 1, Pose(0, 0, 0), 1}};
  change.landmarks = {{0, 0, {0.3f, 0, 1}}, {1, 1, {-0.3f, 0, 1}}};
  teller.Tell(change);
  teller.TellFrame(1, {});
  ViewSettings view = Only(&ViewSettings::landmarks);
  view.landmark_size = 5;
  const Lens lens(view, kWidth, kHeight);
  const auto of = [&](const Shot& shot, double x) {
    const Eigen::Vector2d at = *lens.See({x, 0, 1});
    return shot.At(static_cast<int>(at.x()), static_cast<int>(at.y()));
  };
  const Pixel ground = PixelOf(view.colors.background), ink = PixelOf(view.colors.landmarks);
  Shot shot = Draw(teller.scene, view);
  EXPECT_LE(Difference(of(shot, -0.3), ink), 1);
  EXPECT_LE(Difference(of(shot, 0.3), ground), 1);
  view.other_maps = 0.5;
  shot = Draw(teller.scene, view);
  EXPECT_LE(Difference(of(shot, -0.3), ink), 1);
  EXPECT_NEAR(of(shot, 0.3)[0], (ground[0] + ink[0]) / 2.0, 2);
}

// The camera is relocalized in the first of two maps; no other change is sent.
TEST_F(Layers, TheMapThatTheCameraComesBackToIsShown) {
  Teller teller(Pinhole());
  Change change;
  change.keyframes = {{0, 0, Pose(0, 0, 0), 1}, {1, 1, Pose(0, 0, 0), 1}};
  change.landmarks = {{0, 0, {0.3f, 0, 1}}, {1, 1, {-0.3f, 0, 1}}};
  teller.Tell(change);
  const ViewSettings view = Only(&ViewSettings::landmarks);
  const GlScreen screen(kWidth, kHeight);
  Renderer renderer;
  renderer.Resize(kWidth, kHeight);
  for (uint32_t reference : {1, 0, 1}) {
    teller.TellFrame(reference, {});
    renderer.Show(teller.scene);
    renderer.Draw(view);
    ExpectPoints(screen.Take(), view, {{reference == 0 ? 0.3f : -0.3f, 0, 1}});
  }
  renderer.Release();
}

// Parts of lines behind the eye do not appear in front of it.
TEST_F(Layers, LinesAreCutOffBehindTheEye) {
  Teller teller(Pinhole());
  Change change;
  change.keyframes = {{0, 0, Pose(0, 0, 0), 1}};
  teller.Tell(change);
  teller.TellFrame(0, Pose(0.5, 0, 4));
  teller.TellFrame(0, Pose(0.5, 0, -4));  // passes the eye on its right
  ViewSettings view = Only(&ViewSettings::path);
  view.T_world_eye = {};
  const Shot shot = Draw(teller.scene, view);
  EXPECT_GT(CountLit(shot, view), 50);
  int left = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth / 2; ++x) left += IsLit(shot, x, y, view);
  EXPECT_EQ(left, 0);
  EXPECT_TRUE(IsLit(shot, kWidth - 1, kHeight / 2, view));  // leaves the image on the right
}

}  // namespace
}  // namespace alidade::gles_test::layers_test
