#include "alidade/semidense/gradient_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "support/texture.h"

namespace alidade::gradient_image_test {
namespace {

Camera SmallCamera() {
  Camera camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 130;
  camera.cx = 80;
  camera.cy = 60;
  return camera;
}

TEST(GradientImage, HasMagnitudeAndDirectionOfARamp) {
  cv::Mat ramp(120, 160, CV_8U);
  for (int y = 0; y < ramp.rows; ++y) {
    for (int x = 0; x < ramp.cols; ++x) {
      ramp.at<uint8_t>(y, x) = static_cast<uint8_t>(std::min(255, 10 * (y % 20)));
    }
  }
  const GradientImage image = GradientImageMaker(SmallCamera(), 8, 0.25).Make({ramp});
  // Ten gray levels per pixel divided by the root of the weight; direction downwards, a quarter
  // turn.
  EXPECT_EQ(image.values.at<cv::Vec2b>(50, 40)[0], 100);
  EXPECT_EQ(image.values.at<cv::Vec2b>(50, 40)[1], 20);
  EXPECT_EQ(image.direction.at<uint8_t>(50, 40), GradientImage::kTurn / 4);
}

TEST(GradientImage, NoiseAloneHasHardlyAnEdge) {
  cv::Mat flat(480, 640, CV_8U, cv::Scalar(120));
  AddNoise(flat, 4, 11);
  Camera camera = SmallCamera();
  camera.width = 640;
  camera.height = 480;
  const GradientImage image = GradientImageMaker(camera, 8, 0.23).Make({flat});
  EXPECT_LT(image.edges.size(), 0.0005 * flat.total());
}

TEST(GradientImage, LeavesOutWhatMoves) {
  const cv::Mat picture = MakeTexture(160, 120, 3);
  cv::Mat mask(120, 160, CV_8U, cv::Scalar(0));
  mask.colRange(60, 100) = 255;
  const GradientImageMaker maker(SmallCamera(), 8, 0.23);
  const size_t all = maker.Make({picture}).edges.size();
  const GradientImage image = maker.Make({picture, {}, {}, mask});
  EXPECT_LT(image.edges.size(), all);
  EXPECT_GT(image.edges.size(), all / 3);
  for (const EdgePixel& edge : image.edges) EXPECT_TRUE(edge.x < 60 || edge.x >= 100);
  EXPECT_EQ(image.direction.at<uint8_t>(50, 70), GradientImage::kUnusable);
}

TEST(GradientImage, IsUndistortedAsOpenCvDoesIt) {
  Camera camera = SmallCamera();
  camera.distortion = {-0.2, 0.05, 0.001, -0.0005, 0};
  const cv::Mat picture = MakeTexture(160, 120, 4);
  const GradientImage image = GradientImageMaker(camera, 8, 0.23).Make({picture});
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Mat straight, map_x, map_y;
  cv::initUndistortRectifyMap(K, camera.distortion, cv::Matx33d::eye(), K, picture.size(), CV_32F,
                              map_x, map_y);
  cv::remap(picture, straight, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      ASSERT_NEAR(image.values.at<cv::Vec2b>(y, x)[0], straight.at<uint8_t>(y, x), 2);
    }
  }
}

TEST(GradientImage, HasNoEdgesWhereTheLensDoesNotSee) {
  Camera camera = SmallCamera();
  camera.distortion = {0.3, 0, 0, 0, 0};  // the corners are outside the raw image
  const GradientImage image = GradientImageMaker(camera, 8, 0.23).Make({MakeTexture(160, 120, 4)});
  EXPECT_GT(image.edges.size(), 1000u);
  for (const EdgePixel& edge : image.edges) {
    const Eigen::Vector2d raw = camera.Distort({edge.x, edge.y});
    EXPECT_TRUE(raw.x() >= 0 && raw.y() >= 0 && raw.x() <= 159 && raw.y() <= 119);
  }
}

TEST(GradientImage, CarriesColours) {
  const cv::Mat gray = MakeTexture(160, 120, 5);
  cv::Mat color(120, 160, CV_8UC3, cv::Scalar(1, 2, 3));  // BGR
  const GradientImageMaker maker(SmallCamera(), 8, 0.23);
  EXPECT_EQ(maker.Make({gray, color}).colors.at(10), (std::array<uint8_t, 3>{3, 2, 1}));
  const GradientImage plain = maker.Make({gray});
  EXPECT_EQ(plain.colors.size(), plain.edges.size());
  const EdgePixel& edge = plain.edges.at(10);
  EXPECT_EQ(plain.colors.at(10)[0], gray.at<uint8_t>(edge.y, edge.x));
}

TEST(GradientImage, IsMadeAnewForABetterKnownLens) {
  const cv::Mat picture = MakeTexture(160, 120, 5);
  Camera bent = SmallCamera();
  bent.distortion = {-0.25, 0.05, 0, 0, 0};
  const GradientImageMaker straight(SmallCamera(), 8, 0.23), right(bent, 8, 0.23);
  const GradientImageMaker again(SmallCamera(), bent, 8, 0.23);
  const GradientImage once = straight.Make({picture});
  const GradientImage made = again.Make(once.Straight()), wanted = right.Make({picture});
  cv::Mat a, b;
  cv::extractChannel(made.values, a, 0);
  cv::extractChannel(wanted.values, b, 0);
  const cv::Rect inner(10, 10, 140,
                       100);  // resampled twice: to one gray level and half a pixel
  EXPECT_LT(cv::norm(a(inner), b(inner), cv::NORM_L1) / inner.area(), 1);
  cv::extractChannel(once.values, a, 0);
  EXPECT_GT(cv::norm(a(inner), b(inner), cv::NORM_L1) / inner.area(), 3);
  EXPECT_NEAR(static_cast<double>(made.edges.size()), static_cast<double>(wanted.edges.size()),
              0.05 * static_cast<double>(wanted.edges.size()));
}

TEST(GradientImage, TellsThePictureItWasMadeOf) {
  const cv::Mat picture = MakeTexture(160, 120, 6);
  cv::Mat color, mask(120, 160, CV_8U, cv::Scalar(0));
  cv::cvtColor(picture, color, cv::COLOR_GRAY2BGR);
  color += cv::Scalar(9, 0, 4);
  mask.colRange(0, 20) = 255;
  const GradientImage image =
      GradientImageMaker(SmallCamera(), 8, 0.23).Make({picture, color, {}, mask});
  const Picture told = image.Straight();
  EXPECT_EQ(cv::norm(told.gray, picture, cv::NORM_L1), 0);
  EXPECT_EQ(told.mask.at<uint8_t>(50, 10), 255);
  EXPECT_EQ(told.mask.at<uint8_t>(50, 80), 0);
  ASSERT_GT(image.edges.size(), 100);
  for (const EdgePixel& edge : image.edges)
    ASSERT_EQ(told.color.at<cv::Vec3b>(edge.y, edge.x), color.at<cv::Vec3b>(edge.y, edge.x));
}

}  // namespace
}  // namespace alidade::gradient_image_test
