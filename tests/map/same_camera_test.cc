#include <gtest/gtest.h>

#include <cmath>

#include "alidade/map/map_file.h"
#include "support/expect_error.h"

namespace alidade::same_camera_test {
namespace {

Camera Saved() {
  Camera camera = Camera::FromFieldOfView(640, 480, 66);
  camera.distortion = {-0.2, 0.05, 0.001, 0, 0};
  camera.depth_factor = 5000;
  return camera;
}

TEST(SameCamera, TakesTheSameAndWhatIsTheSameInEffect) {
  CheckSameCamera(Saved(), Saved());
  Camera now = Saved();
  now.fx *= 1.001;  // a third of a pixel at the border
  now.fps = 15;
  CheckSameCamera(Saved(), now);
  now = Saved();
  now.depth_factor = 0;  // a monocular run continuing a map with depth
  CheckSameCamera(Saved(), now);
}

TEST(SameCamera, NamesWhatDiffers) {
  const auto message = [](void (*change)(Camera&)) {
    Camera now = Saved();
    change(now);
    return MessageOf(ErrorKind::kInput, [&] { CheckSameCamera(Saved(), now); });
  };
  EXPECT_THAT(message([](Camera& c) { c.width = 320; }),
              testing::HasSubstr("another camera: width 640 in the map, 320 here"));
  EXPECT_THAT(message([](Camera& c) { c.fx *= 1.01; }), testing::HasSubstr("camera: fx 492.7"));
  EXPECT_THAT(message([](Camera& c) { c.cy += 1; }),
              testing::HasSubstr("cy 239.5 in the map, 240.5"));
  EXPECT_THAT(message([](Camera& c) { c.distortion[1] = 0.15; }), testing::HasSubstr("k2 0.05"));
  EXPECT_THAT(message([](Camera& c) { c.depth_factor = 1000; }),
              testing::HasSubstr("depth_factor 5000 in the map, 1000 here"));
  EXPECT_THAT(message([](Camera& c) { c.fy = NAN; }), testing::HasSubstr("another camera"));
}

}  // namespace
}  // namespace alidade::same_camera_test
