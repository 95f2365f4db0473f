// The complete renderer: many points, successive changes, lost contexts, sizes.
#include "alidade/gles/renderer.h"

#include <gtest/gtest.h>

#include <memory>

#include "alidade/base/error.h"
#include "alidade/base/random.h"
#include "gles/expected.h"
#include "gles/told_scene.h"
#include "support/vga_camera.h"

namespace alidade::gles_test::renderer_test {
namespace {

using gles::DrawStats;
using gles::Renderer;
using gles::ViewSettings;

Se3 At(Random& random) {
  const double x = random.Uniform(-1, 1), y = random.Uniform(-1, 1), z = random.Uniform(-1, 1);
  return {ExpSo3({0.3 * y, 0.3 * z, 0.3 * x}), {x, y, z}};
}

Eigen::Vector3d Seen(Random& random) {
  const double x = random.Uniform(-0.6, 0.6), y = random.Uniform(-0.45, 0.45);
  const double z = random.Uniform(1, 5);
  return {x * z, y * z, z};
}

Change::NewCloud CloudOf(uint32_t keyframe, int points, Random& random) {
  Change::NewCloud cloud{keyframe, {}};
  for (int i = 0; i < points; ++i) {
    const int x = static_cast<int>(random.Below(640)), y = static_cast<int>(random.Below(480));
    ToldPoint point{MakeVgaCamera().Unproject({x, y}, random.Uniform(1, 5)), 0, 255, 0};
    point.red = static_cast<int>(random.Below(256));
    cloud.points.push_back(point);
  }
  return cloud;
}

ViewSettings FromAside() {
  ViewSettings view;
  view.picture = {0, 0, 0.4, 0.4};
  view.T_world_eye = {ExpSo3({0.1, -0.2, 0.1}), {0.5, -0.5, -3}};
  return view;
}

class WholeRenderer : public GlTest {
 protected:
  // The image that a new renderer draws of the scene.
  Shot Anew(const StreamScene& scene, const ViewSettings& view, const GlScreen& screen, int width,
            int height) {
    Renderer renderer;
    renderer.Resize(width, height);
    renderer.Show(scene);
    renderer.Draw(view);
    const Shot shot = screen.Take();
    renderer.Release();
    return shot;
  }
};

// 25 keyframes with 8,000 points each.
TEST_F(WholeRenderer, TwoHundredThousandPointsAreUploadedOnceAndMoveForAFewBytes) {
  constexpr int kWidth = 640, kHeight = 480, kKeyFrames = 25, kPoints = 8000;
  Random random(11);
  Teller teller(MakeVgaCamera());
  Change change;
  for (uint32_t k = 0; k < kKeyFrames; ++k) {
    change.keyframes.push_back({k, 0, At(random), random.Uniform(0.5, 2)});
    change.clouds.push_back(CloudOf(k, kPoints, random));
  }
  teller.Tell(change);
  const GlScreen screen(kWidth, kHeight);
  Renderer renderer;
  renderer.Resize(kWidth, kHeight);
  renderer.Show(teller.scene);
  ViewSettings view = FromAside();
  view.T_world_eye.t.z() = -15;  // small, so that it does not fill the screen
  view.landmarks = view.path = view.keyframes = view.camera = false;
  view.point_size = 1;
  const auto points = [&] {
    std::vector<Eigen::Vector3d> all;
    for (uint32_t k = 0; k < kKeyFrames; ++k) {
      const std::vector<Eigen::Vector3d> kept = KeptPoints(teller.scene, k);
      all.insert(all.end(), kept.begin(), kept.end());
    }
    return all;
  };
  DrawStats stats = renderer.Draw(view);
  EXPECT_EQ(stats.points, static_cast<size_t>(kKeyFrames * kPoints));
  EXPECT_GT(stats.uploaded, static_cast<size_t>(8 * kKeyFrames * kPoints));
  ExpectPoints(screen.Take(), view, points());

  renderer.Show(teller.scene);
  EXPECT_EQ(renderer.Draw(view).uploaded, 0u);

  Change loop;  // all keyframes move
  for (uint32_t k = 0; k < kKeyFrames; ++k) loop.moves.push_back({k, 0, At(random), 1});
  teller.Tell(loop);
  renderer.Show(teller.scene);
  stats = renderer.Draw(view);
  EXPECT_GT(stats.uploaded, 0u);
  EXPECT_LT(stats.uploaded, 4096u);
  ExpectPoints(screen.Take(), view, points());
  renderer.Release();
}

// A map that grows, moves, is culled, loses points and is restarted: after each message the image
// equals that of a renderer that saw only the last state.
TEST_F(WholeRenderer, ShowsAfterManyChangesWhatOneSeesWhoCameLate) {
  constexpr int kWidth = 200, kHeight = 150;
  Random random(5);
  Teller teller(MakeVgaCamera());
  const GlScreen screen(kWidth, kHeight);
  Renderer renderer;
  renderer.Resize(kWidth, kHeight);
  ViewSettings view = FromAside();
  view.point_size = 3;
  std::vector<uint8_t> luma(40 * 30, 90);
  uint32_t next_keyframe = 0, next_landmark = 0;
  std::vector<uint32_t> keyframes, landmarks;
  const auto any = [&](const std::vector<uint32_t>& of) {
    return of[random.Below(static_cast<uint32_t>(of.size()))];
  };
  int culled = 0, emptied = 0;
  for (int step = 0; step < 60; ++step) {
    Change change;
    if (step == 40) {
      change.whole = true;
      keyframes.clear();
      landmarks.clear();
    }
    const uint32_t born = next_keyframe++;
    change.keyframes.push_back({born, 0, At(random), random.Uniform(0.5, 2)});
    keyframes.push_back(born);
    for (uint32_t i = 0; i < 40; ++i) {
      landmarks.push_back(next_landmark++);
      change.landmarks.push_back({landmarks.back(), any(keyframes), Seen(random).cast<float>()});
    }
    change.clouds.push_back(CloudOf(born, static_cast<int>(random.Below(700)), random));
    if (step % 3 == 1) {
      const uint32_t moved = any(keyframes);
      change.moves.push_back({moved, 0, At(random), random.Uniform(0.5, 2)});
      change.landmarks.push_back({any(landmarks), moved, Seen(random).cast<float>()});
    }
    for (int i = 0; i < 15; ++i) {
      const auto at = random.Below(static_cast<uint32_t>(landmarks.size()));
      change.removed.push_back(landmarks[at]);
      landmarks[at] = landmarks.back();
      landmarks.pop_back();
    }
    // First its landmarks are anchored to another keyframe.
    if (step % 4 == 3 && keyframes.size() > 3) {
      ++culled;
      const uint32_t gone = keyframes[keyframes.size() / 2], follows = keyframes.front();
      for (const auto& [id, landmark] : teller.scene.landmarks) {
        const bool lives = std::count(landmarks.begin(), landmarks.end(), id.value) > 0;
        if (lives && landmark.keyframe.value == gone)
          change.landmarks.push_back({id.value, follows, landmark.p});
      }
      for (auto& landmark : change.landmarks)
        if (landmark.keyframe == gone) landmark.keyframe = follows;
      change.culled.push_back({gone, follows, 1.2, At(random)});
      keyframes.erase(keyframes.begin() + static_cast<std::ptrdiff_t>(keyframes.size() / 2));
    }
    if (step % 5 == 2) {
      ++emptied;
      const uint32_t of = keyframes.front();
      change.clouds.push_back(CloudOf(of, step % 2 == 0 ? 0 : 300, random));
    }
    teller.Tell(change);
    const std::vector<ToldFeature> features(static_cast<size_t>(step % 7), {100, 20.0 * step / 3});
    teller.TellFrame(step % 9 == 8 ? KeyFrameId::kNone : any(keyframes), At(random), features);
    renderer.Show(teller.scene);
    luma.assign(luma.size(), static_cast<uint8_t>(step));
    renderer.SetCameraPicture(luma.data(), 40, 30, 40, 0);
    const DrawStats stats = renderer.Draw(view);
    const Shot shot = screen.Take();
    EXPECT_EQ(stats.landmarks, landmarks.size());
    EXPECT_EQ(stats.keyframes, keyframes.size());

    Renderer late;
    late.Resize(kWidth, kHeight);
    late.Show(teller.scene);
    late.SetCameraPicture(luma.data(), 40, 30, 40, 0);
    const DrawStats late_stats = late.Draw(view);
    const Shot expected = screen.Take();
    EXPECT_EQ(stats.points, late_stats.points);
    EXPECT_EQ(stats.segments, late_stats.segments);
    late.Release();
    // Overlapping soft edges are rounded in a different order, and of two points at the same depth
    // the last one drawn is visible. A misplaced point would change nine pixels.
    int different = 0;
    for (size_t i = 0; i < shot.pixels.size(); ++i)
      different += Difference(shot.pixels[i], expected.pixels[i]) > 3;
    ASSERT_LE(different, 4) << "after step " << step;
    ASSERT_GT(CountLit(shot, view), 500);
  }
  EXPECT_GT(culled, 5);
  EXPECT_GT(emptied, 5);
  renderer.Release();
}

void TellAll(Teller& teller, Random& random) {
  Change change;
  for (uint32_t k = 0; k < 6; ++k) {
    change.keyframes.push_back({k, 0, At(random), 1});
    change.clouds.push_back(CloudOf(k, 500, random));
  }
  for (uint32_t i = 0; i < 500; ++i)
    change.landmarks.push_back({i, i % 6, Seen(random).cast<float>()});
  teller.Tell(change);
  for (uint32_t k = 0; k < 6; ++k) teller.TellFrame(k, At(random), {{300, 200}, {20, 30}});
}

TEST_F(WholeRenderer, DrawsTheSameInANewContextAfterOneWasLost) {
  constexpr int kWidth = 240, kHeight = 180;
  Random random(2);
  Teller teller(MakeVgaCamera());
  TellAll(teller, random);
  const ViewSettings view = FromAside();
  const std::vector<uint8_t> luma(64 * 48, 77);
  Renderer renderer;
  renderer.Resize(kWidth, kHeight);
  renderer.Show(teller.scene);
  renderer.SetCameraPicture(luma.data(), 64, 48, 64, 90);
  Shot before;
  {
    const GlScreen screen(kWidth, kHeight);
    renderer.Draw(view);
    before = screen.Take();
  }
  EXPECT_GT(CountLit(before, view), 1000);
  for (int i = 0; i < 3; ++i) {
    context.Destroy();
    // Set while there is no context, shown in the next one.
    renderer.ContextLost();
    renderer.Show(teller.scene);
    context.Make();
    ASSERT_TRUE(context.ok());
    const GlScreen screen(kWidth, kHeight);
    EXPECT_GT(renderer.Draw(view).uploaded, 20000u);
    EXPECT_TRUE(screen.Take() == before) << i;
  }
  // Released by the user and used again.
  const GlScreen screen(kWidth, kHeight);
  renderer.Release();
  renderer.Draw(view);
  EXPECT_TRUE(screen.Take() == before);
  renderer.Release();
}

// Draw() throws when OpenGL reports an error.
TEST_F(WholeRenderer, DrawsOnScreensOfAnySize) {
  Random random(4);
  Teller teller(MakeVgaCamera());
  TellAll(teller, random);
  const std::vector<uint8_t> luma(64 * 48, 77);
  Renderer renderer;
  renderer.Show(teller.scene);
  renderer.SetCameraPicture(luma.data(), 64, 48, 64, 0);
  const std::vector<std::pair<int, int>> sizes = {
      {1, 1},    {1, 9},     {7, 1}, {2, 2},       {641, 479},   {4096, 3},
      {3, 4096}, {480, 640}, {1, 1}, {1920, 1080}, {4096, 4096}, {33, 77}};
  for (const auto& [width, height] : sizes) {
    const GlScreen screen(width, height);
    renderer.Resize(width, height);
    EXPECT_NO_THROW(renderer.Draw(FromAside())) << width << " x " << height;
    const Shot shot = screen.Take();
    if (width > 400 && height > 400) {
      EXPECT_GT(CountLit(shot, FromAside()), 1000);
      ViewSettings points = FromAside();
      points.picture = {0, 0, 0, 0};
      points.points = points.path = points.keyframes = points.camera = false;
      points.landmark_size = 1;
      renderer.Draw(points);
      std::vector<Eigen::Vector3d> expected;
      for (const auto& [id, landmark] : teller.scene.landmarks)
        expected.push_back(teller.scene.PointOf(landmark));
      ExpectPoints(screen.Take(), points, expected);
    }
  }
  // Larger than the context supports: limited to its maximum.
  const GlScreen screen(16, 16);
  renderer.Resize(1000000, 1000000);
  EXPECT_NO_THROW(renderer.Draw(FromAside()));
  renderer.Resize(1000000, 1);
  EXPECT_NO_THROW(renderer.Draw(FromAside()));
  EXPECT_THROW(renderer.Resize(0, 5), Error);
  EXPECT_THROW(renderer.Resize(5, -1), Error);
  renderer.Release();
}

TEST_F(WholeRenderer, DrawsNothingOfAnEmptySceneAndLeavesTheErrorsOfOthersAlone) {
  const GlScreen screen(50, 40);
  Renderer renderer;
  renderer.Resize(50, 40);
  ViewSettings view;
  view.colors.background = {0.2f, 0.4f, 0.6f};
  glEnable(0xdead);  // an error of other code
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  EXPECT_NO_THROW(renderer.Draw(view));
  EXPECT_EQ(CountLit(screen.Take(), view), 0);
  renderer.Show(StreamScene());
  EXPECT_NO_THROW(renderer.Draw(view));
  EXPECT_EQ(CountLit(screen.Take(), view), 0);
  renderer.Release();
}

TEST_F(WholeRenderer, TheSmallerOfMapAndPictureLiesInFront) {
  Random random(4);
  Teller teller(MakeVgaCamera());
  TellAll(teller, random);
  const GlScreen screen(100, 100);
  Renderer renderer;
  renderer.Resize(100, 100);
  renderer.Show(teller.scene);
  const std::vector<uint8_t> luma(50 * 50, 200);
  renderer.SetCameraPicture(luma.data(), 50, 50, 50, 0);
  ViewSettings view = FromAside();
  view.features = false;
  view.picture = {0, 0, 0.5, 0.5};
  renderer.Draw(view);
  Shot shot = screen.Take();
  EXPECT_EQ(shot.At(10, 10)[0], 200);
  EXPECT_EQ(shot.At(49, 49)[0], 200);
  EXPECT_NE(shot.At(90, 90)[0], 200);
  view.map = {0.5, 0.5, 0.5, 0.5};
  view.picture = {0, 0, 1, 1};
  renderer.Draw(view);
  shot = screen.Take();
  EXPECT_EQ(shot.At(10, 90)[0], 200);
  int of_picture = 0;
  for (int y = 50; y < 100; ++y)
    for (int x = 50; x < 100; ++x) of_picture += shot.At(x, y) == Pixel{200, 200, 200, 255};
  EXPECT_EQ(of_picture, 0);
  renderer.Release();
}

TEST(RendererWithoutAContext, TakesScenesAndPicturesAndDrawsThemInTheFirstThereIs) {
  Random random(4);
  Teller teller(MakeVgaCamera());
  TellAll(teller, random);
  auto renderer = std::make_unique<Renderer>();
  renderer->Resize(10, 10);
  renderer->Show(teller.scene);
  const std::vector<uint8_t> luma(100);
  renderer->SetCameraPicture(luma.data(), 10, 10, 10, 0);
  renderer->ContextLost();
  EXPECT_THROW(renderer->Draw(FromAside()), Error);  // no context yet
  GlContext context;
  if (!context.ok()) GTEST_SKIP() << "no OpenGL ES 3 without a window here (Mesa's EGL)";
  const GlScreen screen(10, 10);
  EXPECT_NO_THROW(renderer->Draw(FromAside()));
  renderer.reset();
}

TEST(ViewSettings, ThatCannotBeAreRefused) {
  const auto refuses = [](auto&& change) {
    ViewSettings view;
    EXPECT_NO_THROW(view.Check());
    change(view);
    EXPECT_THROW(view.Check(), Error);
  };
  refuses([](ViewSettings& view) { view.fov = 0; });
  refuses([](ViewSettings& view) { view.fov = 3.2; });
  refuses([](ViewSettings& view) { view.nearest = 0; });
  refuses([](ViewSettings& view) { view.other_maps = 1.5; });
  refuses([](ViewSettings& view) { view.frustum = -1; });
  refuses([](ViewSettings& view) { view.line_width = 0; });
  refuses([](ViewSettings& view) { view.T_world_eye.t.x() = NAN; });
}

}  // namespace
}  // namespace alidade::gles_test::renderer_test
