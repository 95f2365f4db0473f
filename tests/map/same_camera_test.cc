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

Camera Estimated(double focal, double sigma) {
  Camera camera = Camera::FromFieldOfView(640, 480, 66);
  camera.fx = camera.fy = focal;
  camera.focal_sigma = sigma;
  return camera;
}

// At the corner, 400 pixels from the center, 1 % of the focal length is 4 pixels.
TEST(SameCamera, TwoEstimatesAgreeWithinThreeSigmas) {
  const Camera map = Estimated(500, 0.003);
  EXPECT_TRUE(MayBeOneCamera(map, Estimated(505, 0.003)));  // 4 px of 0.5 + 3 x 0.0042 x 400 = 5.6
  EXPECT_FALSE(MayBeOneCamera(map, Estimated(509, 0.003)));
  EXPECT_TRUE(MayBeOneCamera(map, Estimated(505, 0)));  // not known: as the other
  EXPECT_FALSE(MayBeOneCamera(Estimated(500, 0), Estimated(505, 0)));
  EXPECT_FALSE(MayBeOneCamera(map, Estimated(530, 0.35)));  // however uncertain
  Camera shifted = Estimated(505, 0.003);
  shifted.cx += 10;  // 12 pixels are 3 % of half the diagonal
  EXPECT_TRUE(MayBeOneCamera(map, shifted));
  shifted.cx += 5;
  EXPECT_FALSE(MayBeOneCamera(map, shifted));
  Camera small = map;
  small.width = 320;
  EXPECT_FALSE(MayBeOneCamera(map, small));
  Camera deep = map;
  deep.baseline = 0.1;
  EXPECT_FALSE(MayBeOneCamera(map, deep));
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
  EXPECT_THAT(message([](Camera& c) { c.fx *= 1.01; }), testing::HasSubstr("alidade calibrate"));
  EXPECT_THAT(message([](Camera& c) { c.cy += 1; }),
              testing::HasSubstr("cy 239.5 in the map, 240.5"));
  EXPECT_THAT(message([](Camera& c) { c.distortion[1] = 0.15; }), testing::HasSubstr("k2 0.05"));
  EXPECT_THAT(message([](Camera& c) { c.depth_factor = 1000; }),
              testing::HasSubstr("depth_factor 5000 in the map, 1000 here"));
  EXPECT_THAT(message([](Camera& c) { c.fy = NAN; }), testing::HasSubstr("another camera"));
}

}  // namespace
}  // namespace alidade::same_camera_test
