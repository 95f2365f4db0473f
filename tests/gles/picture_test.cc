// The camera image: every pixel is at its position for all strides, rotations and sizes.
#include <gtest/gtest.h>

#include <thread>

#include "alidade/base/error.h"
#include "alidade/gles/renderer.h"
#include "gles/expected.h"
#include "gles/told_scene.h"

namespace alidade::gles_test::picture_test {
namespace {

using gles::Renderer;
using gles::ViewSettings;

uint8_t ValueAt(int x, int y) { return static_cast<uint8_t>(31 * x + 57 * y + x * y % 7); }

// Rows `stride` bytes apart, padded with a value that must not appear.
struct Plane {
  Plane(int width_, int height_, size_t stride_) : width(width_), height(height_), stride(stride_) {
    bytes.assign(stride * static_cast<size_t>(height), 0xee);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        bytes[static_cast<size_t>(y) * stride + static_cast<size_t>(x)] = ValueAt(x, y);
    // The last row ends with its last pixel, because cameras map no bytes beyond it.
    bytes.resize(stride * static_cast<size_t>(height - 1) + static_cast<size_t>(width));
    bytes.shrink_to_fit();
  }
  void Give(Renderer& renderer, int rotation) const {
    renderer.SetCameraPicture(bytes.data(), width, height, stride, rotation);
  }
  int width, height;
  size_t stride;
  std::vector<uint8_t> bytes;
};

// Position of a pixel after rotating the image clockwise, step by step.
std::pair<int, int> Turned(int x, int y, int width, int height, int rotation) {
  for (; rotation > 0; rotation -= 90) {
    const int before = x;
    x = height - 1 - y;
    y = before;
    std::swap(width, height);
  }
  return {x, y};
}

ViewSettings PictureOnly() {
  ViewSettings view;
  view.map = {0, 0, 0, 0};
  view.picture = {0, 0, 1, 1};
  view.colors.background = {1, 0, 0};
  return view;
}

class CameraPicture : public GlTest, public testing::WithParamInterface<int> {};

TEST_P(CameraPicture, IsShownPixelByPixel) {
  const int rotation = GetParam();
  for (const auto& [width, height, stride] :
       {std::tuple(37, 23, 41), {37, 23, 37}, {64, 48, 65}, {1, 1, 3}, {5, 1, 7}, {1, 9, 1}}) {
    const Plane plane(width, height, static_cast<size_t>(stride));
    const bool across = rotation % 180 != 0;
    const int shown_width = across ? height : width, shown_height = across ? width : height;
    const GlScreen screen(shown_width, shown_height);
    Renderer renderer;
    renderer.Resize(shown_width, shown_height);
    plane.Give(renderer, rotation);
    renderer.Draw(PictureOnly());
    const Shot shot = screen.Take();
    int wrong = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto [u, v] = Turned(x, y, width, height, rotation);
        const uint8_t value = ValueAt(x, y);
        wrong += shot.At(u, v) != Pixel{value, value, value, 255};
      }
    }
    EXPECT_EQ(wrong, 0) << width << " x " << height << ", stride " << stride;
    renderer.Release();
  }
}

// In an area with another aspect ratio the image is as large as possible, centered and undistorted.
TEST_P(CameraPicture, IsFittedIntoItsArea) {
  const int rotation = GetParam();
  const Plane plane(40, 30, 43);
  const GlScreen screen(200, 100);
  Renderer renderer;
  renderer.Resize(200, 100);
  plane.Give(renderer, rotation);
  ViewSettings view = PictureOnly();
  view.picture = {0.5, 0, 0.5, 1};  // 100 x 100 on the right
  renderer.Draw(view);
  const Shot shot = screen.Take();
  const bool across = rotation % 180 != 0;
  // 75 of 100 pixels along one axis.
  const int left = across ? 112 : 100, right = across ? 187 : 200;
  const int top = across ? 0 : 12, bottom = across ? 100 : 87;
  int outside = 0, inside = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) {
      const bool within = x >= left && x < right && y >= top && y < bottom;
      const bool ground = shot.At(x, y) == Pixel{255, 0, 0, 255};
      outside += !within && !ground;
      inside += within && ground;
    }
  }
  // The remainder may be on either side.
  EXPECT_LE(outside, 100);
  EXPECT_LE(inside, 100);
  renderer.Release();
}

TEST_P(CameraPicture, HasTheFeaturesOnTheirPixels) {
  const int rotation = GetParam();
  Teller teller(Camera::FromFieldOfView(160, 120, 60));
  Change change;
  change.keyframes = {{0, 0, {}, 1}};
  teller.Tell(change);
  const std::vector<ToldFeature> features = {{20, 30, stream::Use::matched},
                                             {100, 30, stream::Use::fresh},
                                             {20, 90, stream::Use::moving},
                                             {140, 100, stream::Use::free}};
  teller.TellFrame(0, {}, features);
  const bool across = rotation % 180 != 0;
  const int width = across ? 240 : 320, height = across ? 320 : 240;  // twice as large
  const GlScreen screen(width, height);
  Renderer renderer;
  renderer.Resize(width, height);
  Plane(80, 60, 81).Give(renderer, rotation);  // half the size of the processed image
  renderer.Show(teller.scene);
  ViewSettings view = PictureOnly();
  view.feature_size = 7;
  for (bool unmatched : {false, true}) {
    view.unmatched_features = unmatched;
    renderer.Draw(view);
    const Shot shot = screen.Take();
    const gles::Color inks[] = {view.colors.unmatched, view.colors.matched, view.colors.fresh,
                                view.colors.moving};
    for (const ToldFeature& feature : features) {
      const auto [u, v] =
          Turned(static_cast<int>(feature.x), static_cast<int>(feature.y), 160, 120, rotation);
      const gles::Color ink = inks[static_cast<size_t>(feature.use)];
      const bool shown = feature.use != stream::Use::free || unmatched;
      int close = 0;
      for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx)
          close += Difference(shot.At(2 * u + dx, 2 * v + dy), PixelOf(ink)) <= 1;
      EXPECT_EQ(close, shown ? 4 : 0) << "at " << feature.x << ", " << feature.y;
    }
  }
  view.features = false;
  renderer.Draw(view);
  const Shot bare = screen.Take();
  for (const Pixel& pixel : bare.pixels) ASSERT_EQ(pixel[0], pixel[2]);  // gray
  renderer.Release();
}

INSTANTIATE_TEST_SUITE_P(Turned, CameraPicture, testing::Values(0, 90, 180, 270));

class CameraPictures : public GlTest {};

TEST_F(CameraPictures, LargerThanATextureAreThinned) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (most >= 65535) GTEST_SKIP() << "textures of " << most << " pixels";
  const Plane plane(most + 3, 2, static_cast<size_t>(most) + 5);
  const GlScreen screen(64, 64);
  Renderer renderer;
  renderer.Resize(64, 64);
  plane.Give(renderer, 0);
  const gles::DrawStats stats = renderer.Draw(PictureOnly());
  EXPECT_EQ(stats.uploaded, static_cast<size_t>(most + 4) / 2);
  renderer.Release();
}

TEST_F(CameraPictures, ThatCannotBeAreRefusedWithAReason) {
  Renderer renderer;
  const std::vector<uint8_t> bytes(100);
  EXPECT_THROW(renderer.SetCameraPicture(bytes.data(), 0, 10, 10, 0), Error);
  EXPECT_THROW(renderer.SetCameraPicture(bytes.data(), 10, -1, 10, 0), Error);
  EXPECT_THROW(renderer.SetCameraPicture(bytes.data(), 10, 10, 9, 0), Error);
  EXPECT_THROW(renderer.SetCameraPicture(bytes.data(), 10, 10, 10, 45), Error);
  EXPECT_THROW(renderer.SetCameraPicture(bytes.data(), 10, 10, 10, 360), Error);
  EXPECT_THROW(renderer.SetCameraPicture(nullptr, 10, 10, 10, 0), Error);
  EXPECT_NO_THROW(renderer.SetCameraPicture(bytes.data(), 10, 10, 10, 270));
}

// One thread sets images while another draws: every drawn image is complete.
TEST_F(CameraPictures, ComeFromAnotherThread) {
  constexpr int kSide = 64, kPictures = 400;
  const GlScreen screen(kSide, kSide);
  Renderer renderer;
  renderer.Resize(kSide, kSide);
  const auto give = [&](int i) {
    const std::vector<uint8_t> bytes(kSide * kSide, static_cast<uint8_t>(i % 251));
    renderer.SetCameraPicture(bytes.data(), kSide, kSide, kSide, 90 * (i % 4));
  };
  give(0);
  std::thread camera([&] {
    for (int i = 1; i <= kPictures; ++i) give(i);
  });
  int torn = 0;
  for (int i = 0; i < 50; ++i) {
    renderer.Draw(PictureOnly());
    const Shot shot = screen.Take();
    torn += std::any_of(shot.pixels.begin(), shot.pixels.end(),
                        [&](const Pixel& pixel) { return pixel != shot.pixels.front(); });
  }
  camera.join();
  EXPECT_EQ(torn, 0);
  renderer.Draw(PictureOnly());
  EXPECT_EQ(screen.Take().At(5, 5)[0], kPictures % 251);
  renderer.Release();
}

}  // namespace
}  // namespace alidade::gles_test::picture_test
