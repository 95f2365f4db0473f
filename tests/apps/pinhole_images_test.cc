// Undistorted images against OpenCV's undistortion.
#include "alidade/run/export/pinhole_images.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace alidade::pinhole_images_test {
namespace {

Camera Distorted(double k1) {
  Camera camera = Camera::FromFieldOfView(320, 240, 75);
  camera.cx += 6.3;
  camera.cy -= 4.8;
  camera.distortion = {k1, 0.04, 0.0012, -0.0008, 0};
  return camera;
}

// Smooth, so that interpolation costs nothing.
cv::Mat Waves(int width, int height) {
  cv::Mat image(height, width, CV_8U);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(
          128 + 60 * std::sin(0.11 * x * 320 / width) + 60 * std::cos(0.13 * y * 240 / height));
  }
  return image;
}

cv::Matx33d MatrixOf(const Camera& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

TEST(PinholeImages, AreThoseOfOpenCv) {
  for (const double k1 : {-0.28, 0.12}) {
    const Camera camera = Distorted(k1);
    const PinholeImages pinhole(camera, {320, 240});
    const cv::Mat image = Waves(320, 240), ours = pinhole.Apply(image);
    const cv::Vec<double, 5> distortion(camera.distortion.data());
    cv::Mat x, y, theirs;
    const cv::Size size(pinhole.camera().width, pinhole.camera().height);
    cv::initUndistortRectifyMap(MatrixOf(camera), distortion, cv::noArray(),
                                MatrixOf(pinhole.camera()), size, CV_32FC1, x, y);
    cv::remap(image, theirs, x, y, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    ASSERT_EQ(ours.size(), theirs.size());
    cv::Mat difference;
    cv::absdiff(ours, theirs, difference);
    double most = 0;
    cv::minMaxLoc(difference, nullptr, &most);
    EXPECT_LE(most, 3) << k1;  // 0.02 pixels of the grid, 1/32 of OpenCV's, at 8 levels per pixel
  }
}

// No pixel lies outside the recorded image, and one more column or row on any side would.
TEST(PinholeImages, AreTheLargestWithoutBlackBorders) {
  for (const double k1 : {-0.28, 0.12}) {
    const Camera camera = Distorted(k1);
    const PinholeImages pinhole(camera, {320, 240});
    const Camera& out = pinhole.camera();
    const auto outside = [&](double u, double v) {
      const Eigen::Vector2d raw = camera.Distort(camera.Project(out.Unproject({u, v})));
      return raw.x() < -1e-6 || raw.y() < -1e-6 || raw.x() > 319 + 1e-6 || raw.y() > 239 + 1e-6;
    };
    int beyond_left = 0, beyond_right = 0, beyond_top = 0, beyond_bottom = 0;
    for (int v = 0; v < out.height; ++v) {
      EXPECT_FALSE(outside(0, v) || outside(out.width - 1, v)) << v;
      beyond_left += outside(-1, v);
      beyond_right += outside(out.width, v);
    }
    for (int u = 0; u < out.width; ++u) {
      EXPECT_FALSE(outside(u, 0) || outside(u, out.height - 1)) << u;
      beyond_top += outside(u, -1);
      beyond_bottom += outside(u, out.height);
    }
    EXPECT_GT(beyond_left, 0);
    EXPECT_GT(beyond_right, 0);
    EXPECT_GT(beyond_top, 0);
    EXPECT_GT(beyond_bottom, 0);
  }
}

TEST(PinholeImages, AnImageWithoutDistortionStaysAsItIs) {
  const Camera camera = Camera::FromFieldOfView(320, 240, 75);
  const PinholeImages pinhole(camera, {320, 240});
  const cv::Mat image = Waves(320, 240);
  EXPECT_EQ(pinhole.Apply(image).data, image.data);
  EXPECT_EQ(pinhole.camera().cx, camera.cx);
}

// The map was made of images of half the size; the pinhole images have the recorded resolution.
TEST(PinholeImages, ScaledDownMapsGiveImagesOfFullSize) {
  const Camera small = Distorted(-0.28), full = small.ScaledToWidth(640);
  const PinholeImages of_small(small, {640, 480}), of_full(full, {640, 480});
  EXPECT_EQ(of_small.camera().width, of_full.camera().width);
  EXPECT_NEAR(of_small.camera().fx, of_full.camera().fx, 1e-9);
  EXPECT_NEAR(of_small.camera().cx, of_full.camera().cx, 1e-6);
  const Eigen::Vector2d raw(30, 200), doubled((30 + 0.5) * 2 - 0.5, (200 + 0.5) * 2 - 0.5);
  EXPECT_LT((of_small.InPinhole(raw) - of_full.InPinhole(doubled)).norm(), 1e-6);
}

TEST(PinholeImages, CenteredOnesHaveThePrincipalPointInTheMiddle) {
  const PinholeImages pinhole(Distorted(-0.28), {320, 240}, {.centered = true});
  EXPECT_NEAR(pinhole.camera().cx, (pinhole.camera().width - 1) / 2.0, 1e-9);
  EXPECT_NEAR(pinhole.camera().cy, (pinhole.camera().height - 1) / 2.0, 1e-9);
}

// A keypoint and the pixel that shows it are the same place, also for an image that was read row by
// row while the camera turned and moved.
TEST(PinholeImages, KeypointsLieWhereTheImageShowsThem) {
  Camera camera = Distorted(-0.2);
  camera.readout = {0, 0.03};
  ReadoutMotion readout;
  readout.motion << 0.3, -0.1, 0.2, 0.4, -0.7, 0.5;
  readout.inverse_depth = 0.5;
  for (const ReadoutMotion& motion : {ReadoutMotion{}, readout}) {
    const PinholeImages pinhole(camera, {320, 240});
    for (const cv::Point raw : {cv::Point(60, 40), cv::Point(250, 60), cv::Point(160, 200)}) {
      cv::Mat image = cv::Mat::zeros(240, 320, CV_8U);
      cv::circle(image, raw, 3, 255, cv::FILLED);
      const cv::Moments moments = cv::moments(pinhole.Apply(image, motion));
      const Eigen::Vector2d seen(moments.m10 / moments.m00, moments.m01 / moments.m00);
      const Eigen::Vector2d told = pinhole.InPinhole(Eigen::Vector2d(raw.x, raw.y), motion);
      EXPECT_LT((seen - told).norm(), 0.15) << raw;
    }
  }
  EXPECT_GT((PinholeImages(camera, {320, 240}).InPinhole({60, 40}, readout) -
             PinholeImages(camera, {320, 240}).InPinhole({60, 40}))
                .norm(),
            1);  // the motion matters
}

}  // namespace
}  // namespace alidade::pinhole_images_test
