#include "alidade/features/describe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "support/texture.h"

namespace alidade::describe_test {
namespace {

TEST(PatchAngle, PointsToTheCentroidOfTheDisc) {
  const cv::Mat image = MakeTexture(120, 90, 2);
  for (int y = 20; y < 70; y += 7) {
    for (int x = 20; x < 100; x += 9) {
      double mx = 0, my = 0;
      for (int v = -15; v <= 15; ++v) {
        for (int u = -15; u <= 15; ++u) {
          if (u * u + v * v > 225) continue;
          mx += u * image.at<uint8_t>(y + v, x + u);
          my += v * image.at<uint8_t>(y + v, x + u);
        }
      }
      EXPECT_NEAR(PatchAngle(image, x, y), std::atan2(my, mx), 1e-5);
    }
  }
}

TEST(PatchAngle, TurnsWithTheImage) {
  const cv::Mat image = MakeTexture(61, 61, 7);
  cv::Mat turned;
  cv::rotate(image, turned,
             // The y axis points down, so this rotates x towards y by +90 degrees.
             cv::ROTATE_90_CLOCKWISE);
  const double turn = PatchAngle(turned, 30, 30) - PatchAngle(image, 30, 30);
  EXPECT_NEAR(std::remainder(turn - std::numbers::pi / 2, 2 * std::numbers::pi), 0, 1e-5);
}

TEST(Describe, ReadsTheSameBitsFromATurnedPatch) {
  const cv::Mat image = MakeTexture(61, 61, 7);
  const SteeredPattern pattern(static_cast<int>(image.step[0]));
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  const Descriptor a = pattern.Describe(image.ptr(30) + 30, 0);
  const Descriptor b =
      pattern.Describe(turned.ptr(30) + 30, static_cast<float>(std::numbers::pi / 2));
  // The same pixels, except where the pattern rounds differently.
  EXPECT_LE(HammingDistance(a, b), 4);
  const Descriptor c = pattern.Describe(turned.ptr(30) + 30, 0);
  EXPECT_GE(HammingDistance(a, c), 64);
}

TEST(Describe, TakesAnglesOfAllTheCircle) {
  const cv::Mat image = MakeTexture(61, 61, 3);
  const SteeredPattern pattern(static_cast<int>(image.step[0]));
  const float pi = std::numbers::pi_v<float>;
  EXPECT_EQ(pattern.Describe(image.ptr(30) + 30, pi), pattern.Describe(image.ptr(30) + 30, -pi));
}

TEST(Describe, HasNoTwoBitsAlikeAndBalancedOnes) {
  // Over many patches every bit is balanced, and no two bits are always equal or always different.
  std::vector<Descriptor> descriptors;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    cv::Mat image = MakeTexture(400, 300, seed);
    cv::blur(image, image, cv::Size(5, 5));
    const SteeredPattern pattern(static_cast<int>(image.step[0]));
    for (int y = 20; y < 280; y += 11) {
      for (int x = 20; x < 380; x += 11) {
        descriptors.push_back(pattern.Describe(image.ptr(y) + x, PatchAngle(image, x, y)));
      }
    }
  }
  const auto bit = [](const Descriptor& d, int i) { return d.words[i / 64] >> (i % 64) & 1; };
  const int count = static_cast<int>(descriptors.size());
  for (int i = 0; i < 256; ++i) {
    int ones = 0;
    for (const Descriptor& d : descriptors) ones += static_cast<int>(bit(d, i));
    EXPECT_GT(ones, 0.05 * count) << "bit " << i;
    EXPECT_LT(ones, 0.95 * count) << "bit " << i;
    for (int j = 0; j < i; j += 5) {
      int differ = 0;
      for (const Descriptor& d : descriptors) differ += bit(d, i) != bit(d, j);
      EXPECT_GT(differ, 0.05 * count) << "bits " << i << " and " << j;
      EXPECT_LT(differ, 0.95 * count) << "bits " << i << " and " << j;
    }
  }
}

}  // namespace
}  // namespace alidade::describe_test
