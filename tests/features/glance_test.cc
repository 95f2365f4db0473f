#include "alidade/features/glance.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "alidade/base/random.h"

namespace alidade::glance_test {
namespace {

constexpr int kWidth = 480, kHeight = 360;

// Outlines of doors and shelves, shifted by `shift`, with a textured object in front at `thing`.
cv::Mat Room(cv::Point shift, cv::Point thing, double gain = 1) {
  cv::Mat image(kHeight, kWidth, CV_8UC1, cv::Scalar(120));
  for (int i = -1; i < 6; ++i) {
    const cv::Rect door(i * 100 + shift.x, 40 + shift.y, 60, 260);
    cv::rectangle(image, door, cv::Scalar(90 + 10 * (i % 3)), cv::FILLED);
  }
  Random texture(3), noise(7 + thing.x + shift.x);
  for (int y = 0; y < 80; y += 4) {
    for (int x = 0; x < 80; x += 4) {
      const cv::Rect patch(thing.x + x, thing.y + y, 4, 4);
      cv::rectangle(image, patch, cv::Scalar(texture.Uniform(0, 255)), cv::FILLED);
    }
  }
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double v = gain * image.at<uint8_t>(y, x) + 3 * noise.Gaussian();
      image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(v);
    }
  }
  return image;
}

double Share(const cv::Mat& a, const cv::Mat& b) { return StillShare(Glance(a), Glance(b)); }

TEST(StillShare, TellsAStillCameraByTheEdgesBehindAThing) {
  const cv::Mat before = Room({0, 0}, {150, 150});
  EXPECT_GT(Share(before, Room({0, 0}, {162, 150})), 0.6);
  EXPECT_GT(Share(before, Room({0, 0}, {162, 150}, 1.15)), 0.6);  // exposure drifts
}

TEST(StillShare, IsSmallWhenTheCameraMoves) {
  const cv::Mat before = Room({0, 0}, {150, 150});
  EXPECT_LT(Share(before, Room({6, 0}, {162, 150})), 0.2);
  EXPECT_LT(Share(before, Room({0, 6}, {150, 162})), 0.2);
  EXPECT_LT(Share(before, Room({5, 5}, {158, 158})), 0.2);
}

TEST(StillShare, EdgesInOneDirectionTellNothing) {
  cv::Mat stripes(kHeight, kWidth, CV_8UC1);
  for (int y = 0; y < kHeight; ++y) stripes.row(y) = cv::Scalar(y / 30 % 2 ? 60 : 180);
  EXPECT_EQ(Share(stripes, stripes), 0);
}

TEST(StillShare, WhatIsFixedToTheCameraDoesNotStandStill) {
  const auto with_bonnet = [](cv::Mat image) {
    for (int i = 0; i < 12; ++i) {
      cv::rectangle(image, cv::Rect(40 * i, 300, 25, 25), cv::Scalar(20), cv::FILLED);
    }
    return image;
  };
  EXPECT_EQ(Share(with_bonnet(Room({0, 0}, {150, 150})), with_bonnet(Room({9, 12}, {162, 150}))),
            0);
}

TEST(StillShare, NothingToCompareIsZero) {
  const cv::Mat blank(kHeight, kWidth, CV_8UC1, cv::Scalar(80));
  EXPECT_EQ(Share(blank, blank), 0);
  EXPECT_EQ(StillShare({}, {}), 0);
  EXPECT_EQ(StillShare(Glance(blank), Glance(blank(cv::Rect(0, 0, 480, 200)))), 0);
  EXPECT_EQ(Glance(cv::Mat(1, 1, CV_8UC1, cv::Scalar(1))).size(), cv::Size(1, 1));
}

}  // namespace
}  // namespace alidade::glance_test
