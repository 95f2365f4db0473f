#include "alidade/features/depth_image.h"

#include <gtest/gtest.h>

namespace alidade::depth_image_test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Camera CameraWith(double depth_factor) {
  Camera camera;
  camera.depth_factor = depth_factor;
  return camera;
}

TEST(DepthImage, IsInMetresWhateverItIsStoredIn) {
  cv::Mat_<uint16_t> units(3, 4, uint16_t{0});
  units(1, 2) = 12500;
  units(2, 3) = 65535;
  const Camera camera = CameraWith(5000);
  const DepthImage integers(units, camera);
  EXPECT_FLOAT_EQ(integers.At(2, 1), 2.5f);
  EXPECT_FLOAT_EQ(integers.At(3, 2), 13.107f);
  cv::Mat_<float> metres(3, 4, 0.0f);
  metres(1, 2) = 2.5f;
  const DepthImage floats(metres, camera);
  EXPECT_EQ(floats.At(2, 1), 2.5f);
  EXPECT_EQ(floats.size(), cv::Size(4, 3));
}

TEST(DepthImage, IsZeroWhereThereIsNoReading) {
  const cv::Mat_<uint16_t> units(2, 2, uint16_t{0});
  const Camera camera = CameraWith(1000);
  EXPECT_EQ(DepthImage(units, camera).At(1, 1), 0);
  const cv::Mat_<float> metres = (cv::Mat_<float>(1, 4) << 0, -1, kNaN, kInfinity);
  const DepthImage floats(metres, camera);
  for (int x = 0; x < 4; ++x) EXPECT_EQ(floats.At(x, 0), 0) << x;
  // Integers without a known unit are invalid.
  const cv::Mat_<uint16_t> unknown = (cv::Mat_<uint16_t>(1, 2) << 0, 700);
  const Camera without = CameraWith(0);
  EXPECT_EQ(DepthImage(unknown, without).At(0, 0), 0);
  EXPECT_EQ(DepthImage(unknown, without).At(1, 0), 0);
}

TEST(DepthImage, IsZeroOutside) {
  const cv::Mat_<float> metres(3, 4, 1.0f);
  const Camera camera = CameraWith(0);
  const DepthImage depth(metres, camera);
  EXPECT_EQ(depth.At(0, 0), 1);
  EXPECT_EQ(depth.At(3, 2), 1);
  EXPECT_EQ(depth.At(-1, 0), 0);
  EXPECT_EQ(depth.At(0, -1), 0);
  EXPECT_EQ(depth.At(4, 0), 0);
  EXPECT_EQ(depth.At(0, 3), 0);
  const cv::Mat none;
  EXPECT_EQ(DepthImage(none, camera).At(0, 0), 0);
}

}  // namespace
}  // namespace alidade::depth_image_test
