// Parts fixed to the camera, in views of a textured wall 2 m away.
#include "alidade/dynamics/fixed_parts.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "alidade/features/extractor.h"
#include "support/texture.h"
#include "support/vga_camera.h"

namespace alidade::fixed_parts_test {
namespace {

constexpr double kPeriod = 0.1;  // seconds between frames
constexpr int kWall = 1600;      // pixels of the wall's picture, in each direction

class FixedPartsTest : public testing::Test {
 protected:
  // The part of the wall around (x, y), wall pixels, magnified.
  static cv::Mat View(double x, double y, double magnified = 1) {
    static const cv::Mat wall = MakeTexture(kWall, kWall, 5);
    const cv::Matx23d inverse(1 / magnified, 0, x - 320 / magnified,  //
                              0, 1 / magnified, y - 240 / magnified);
    cv::Mat view;
    cv::warpAffine(wall, view, inverse, {640, 480}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REFLECT);
    return view;
  }
  static void PutOver(cv::Mat& view, const cv::Rect& place, uint64_t seed, int from = 0) {
    const cv::Mat thing = MakeTexture(1280, 480, seed);
    thing(cv::Rect(from, 0, place.width, place.height)).copyTo(view(place));
  }
  // True when a part was found.
  bool See(cv::Mat view) {
    AddNoise(view, 2, 100 + static_cast<uint64_t>(number_));
    auto frame =
        std::make_shared<Frame>(extractor_.Extract(view, camera_, kPeriod * number_, number_));
    ++number_;
    return parts_.See(view, frame);
  }
  bool Marks(double x, double y) const {
    const cv::Mat& mask = parts_.mask();
    return !mask.empty() && mask.at<uint8_t>(static_cast<int>(y * mask.rows / 480),
                                             static_cast<int>(x * mask.cols / 640)) != 0;
  }

  Camera camera_ = MakeVgaCamera();
  Extractor extractor_{ExtractorSettings{}};
  FixedParts parts_{camera_};
  int number_ = 0;
};

TEST_F(FixedPartsTest, AHandInAMovingImageIsFoundWithinTwoSeconds) {
  const cv::Rect hand(380, 280, 180, 200);
  int found = -1;
  for (int i = 0; i < 20 && found < 0; ++i) {
    cv::Mat view = View(500 + 18 * i, 700 + 40 * std::sin(0.3 * i));
    PutOver(view, hand, 9);
    if (See(view)) found = i;
  }
  ASSERT_GE(found, 0);
  EXPECT_GT(found, 4) << "two comparisons cannot be enough";
  EXPECT_TRUE(Marks(470, 380));
  EXPECT_FALSE(Marks(100, 100));
  EXPECT_FALSE(Marks(200, 400));
  EXPECT_NEAR(parts_.share(), 180 * 200 / (640.0 * 480), 0.03);
}

TEST_F(FixedPartsTest, AMovingImageHasNone) {
  for (int i = 0; i < 30; ++i)
    EXPECT_FALSE(See(View(500 + 18 * i, 700 + 40 * std::sin(0.3 * i)))) << i;
  EXPECT_TRUE(parts_.mask().empty());
}

TEST_F(FixedPartsTest, TheFocusOfExpansionIsNone) {
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(See(View(800, 800, 1 + 0.06 * i))) << i;
  EXPECT_TRUE(parts_.mask().empty());
}

TEST_F(FixedPartsTest, ASceneBehindAPassingObjectIsNone) {
  for (int i = 0; i < 40; ++i) {
    cv::Mat view = View(800, 800);
    const int left = -480 + 45 * i;  // 480 pixels wide, seen from frame 1 to 24
    const int begin = std::max(0, left), end = std::min(640, left + 480);
    if (end > begin) PutOver(view, {begin, 0, end - begin, 480}, 11, begin - left);
    EXPECT_FALSE(See(view)) << i;
  }
}

TEST_F(FixedPartsTest, WhatMovesAgainIsUsedAgain) {
  const cv::Rect hand(380, 280, 180, 200);
  for (int i = 0; i < 20; ++i) {
    cv::Mat view = View(500 + 18 * i, 700);
    PutOver(view, hand, 9);
    See(view);
  }
  ASSERT_TRUE(Marks(470, 380));
  for (int i = 20; i < 50; ++i) See(View(500 + 18 * i, 700));
  EXPECT_FALSE(Marks(470, 380));
  EXPECT_EQ(parts_.share(), 0);
}

}  // namespace
}  // namespace alidade::fixed_parts_test
