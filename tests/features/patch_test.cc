#include "alidade/features/patch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "alidade/features/pyramid.h"

namespace alidade::patch_test {
namespace {

// Brightness as a smooth function of the place, gray levels; no two places look alike.
double Brightness(double x, double y) {
  return 125 + 40 * std::sin(0.31 * x + 0.12 * y) + 35 * std::sin(0.23 * y - 0.07 * x + 1) +
         25 * std::sin(0.011 * x * y / 10 + 0.17 * x);
}

// The image in which pixel q shows what is at `origin` + warp q, with another exposure.
cv::Mat ImageOf(const Eigen::Matrix2d& warp, const Eigen::Vector2d& origin, double gain,
                double offset) {
  cv::Mat image(120, 160, CV_8U);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2d p = origin + warp * Eigen::Vector2d(x, y);
      image.at<uint8_t>(y, x) =
          cv::saturate_cast<uint8_t>(gain * Brightness(p.x(), p.y()) + offset);
    }
  }
  return image;
}

const Eigen::Matrix2f kUnchanged = Eigen::Matrix2f::Identity();

TEST(Patch, IsFoundToAFractionOfAPixelInAnotherExposure) {
  const cv::Mat reference = ImageOf(Eigen::Matrix2d::Identity(), {0, 0}, 1, 0);
  // A pixel of the second image shows what is (2.3, -1.6) away in the first.
  const cv::Mat image = ImageOf(Eigen::Matrix2d::Identity(), {2.3, -1.6}, 0.6, 30);
  int found = 0;
  for (float x = 30.25f; x < 130; x += 12.4f) {
    for (float y = 30.75f; y < 90; y += 11.3f) {
      Patch patch;
      if (!CutPatch(reference, {x, y}, kUnchanged, patch)) continue;
      Eigen::Vector2f place(x, y);
      if (!AlignPatch(patch, image, 6, 0.9f, place)) continue;
      ++found;
      EXPECT_NEAR(place.x(), x - 2.3f, 0.2f);
      EXPECT_NEAR(place.y(), y + 1.6f, 0.2f);
    }
  }
  EXPECT_GE(found, 40);  // of 54
}

TEST(Patch, IsWarpedIntoTheOtherImage) {
  // Pixels of the reference per pixel of the image: turned by 15 degrees, 1.2 times closer.
  const double angle = 15 * M_PI / 180;
  Eigen::Matrix2d warp;
  warp << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  warp /= 1.2;
  const Eigen::Vector2d middle(80, 60);
  const cv::Mat reference = ImageOf(Eigen::Matrix2d::Identity(), {0, 0}, 1, 0);
  const cv::Mat image = ImageOf(warp, middle - warp * middle, 1, 0);
  int found = 0;
  for (float x = 60; x <= 100; x += 10) {
    for (float y = 45; y <= 75; y += 10) {
      Patch patch;
      if (!CutPatch(reference, {x, y}, warp.cast<float>(), patch)) continue;
      const Eigen::Vector2d truth = middle + warp.inverse() * (Eigen::Vector2d(x, y) - middle);
      Eigen::Vector2f place = truth.cast<float>() + Eigen::Vector2f(1.5f, -1);
      if (!AlignPatch(patch, image, 6, 0.9f, place)) continue;
      ++found;
      EXPECT_LT((place.cast<double>() - truth).norm(), 0.1);
    }
  }
  EXPECT_GE(found, 15);  // of 20
}

TEST(Patch, OfAnotherPlaceIsNotFound) {
  const cv::Mat reference = ImageOf(Eigen::Matrix2d::Identity(), {0, 0}, 1, 0);
  const cv::Mat other = ImageOf(Eigen::Matrix2d::Identity(), {300, 500}, 1, 0);
  int found = 0, tried = 0;
  for (float x = 30; x < 130; x += 10) {
    for (float y = 30; y < 90; y += 10) {
      Patch patch;
      if (!CutPatch(reference, {x, y}, kUnchanged, patch)) continue;
      Eigen::Vector2f place(x, y);
      ++tried;
      found += AlignPatch(patch, other, 6, 0.9f, place);
    }
  }
  EXPECT_LE(found, tried / 5);
}

TEST(Patch, WithoutBothCoordinatesIsRefused) {
  const cv::Mat flat(120, 160, CV_8U, cv::Scalar(90));
  cv::Mat edge = flat.clone();
  edge.colRange(80, 160).setTo(200);
  cv::Mat corner = flat.clone();
  corner(cv::Rect(80, 60, 80, 60)).setTo(200);
  Patch patch;
  EXPECT_FALSE(CutPatch(flat, {80, 60}, kUnchanged, patch));
  EXPECT_FALSE(CutPatch(edge, {80, 60}, kUnchanged, patch));
  EXPECT_TRUE(CutPatch(corner, {80, 60}, kUnchanged, patch));
}

TEST(Patch, BeyondTheImageIsRefused) {
  const cv::Mat image = ImageOf(Eigen::Matrix2d::Identity(), {0, 0}, 1, 0);
  Patch patch;
  for (const auto& [x, y] : {std::pair{2.0f, 60.0f},
                             {157.0f, 60.0f},
                             {80.0f, 3.0f},
                             {80.0f, 117.0f},
                             {-50.0f, 60.0f},
                             {NAN, 60.0f},
                             {1e30f, 1e30f}})
    EXPECT_FALSE(CutPatch(image, {x, y}, kUnchanged, patch)) << x << ' ' << y;
  ASSERT_TRUE(CutPatch(image, {80, 60}, kUnchanged, patch));
  for (const auto& [x, y] : {std::pair{4.0f, 60.0f}, {155.0f, 60.0f}, {NAN, 60.0f}, {1e30f, 0.0f}})
    EXPECT_FALSE(StepOf(patch, image, {x, y}).inside) << x << ' ' << y;
}

TEST(HalvedImages, HaveTheMeanOfFourPixels) {
  cv::Mat image(67, 101, CV_8U);
  cv::randu(image, 0, 255);
  const std::vector<cv::Mat> halved = HalvedImages(image, 8);
  ASSERT_EQ(halved.size(), 3u);  // the next would be 12 x 8
  EXPECT_EQ(halved[0].data, image.data);
  EXPECT_EQ(halved[1].size(), cv::Size(50, 33));
  EXPECT_EQ(halved[2].size(), cv::Size(25, 16));
  for (int y = 0; y < 33; ++y) {
    for (int x = 0; x < 50; ++x) {
      const int sum = image.at<uint8_t>(2 * y, 2 * x) + image.at<uint8_t>(2 * y, 2 * x + 1) +
                      image.at<uint8_t>(2 * y + 1, 2 * x) + image.at<uint8_t>(2 * y + 1, 2 * x + 1);
      EXPECT_NEAR(halved[1].at<uint8_t>(y, x), sum / 4.0, 0.5);
    }
  }
}

}  // namespace
}  // namespace alidade::patch_test
