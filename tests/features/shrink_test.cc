#include "alidade/features/shrink.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "support/texture.h"

namespace alidade::shrink_test {
namespace {

// Noise, which does not hide an error of rounding as smooth images would; a part of a larger image.
cv::Mat Noise(cv::Size size, int type, Random& random) {
  cv::Mat large(size.height + 3, size.width + 5, type);
  for (int y = 0; y < large.rows; ++y) {
    for (int x = 0; x < large.cols * large.channels(); ++x)
      large.ptr<uint8_t>(y)[x] = static_cast<uint8_t>(random.Below(256));
  }
  return large(cv::Rect({2, 1}, size));
}

cv::Mat OpenCvs(const cv::Mat& image, cv::Size size, int interpolation) {
  cv::Mat small;
  cv::resize(image, small, size, 0, 0, interpolation);
  return small;
}

void ExpectTheSame(const cv::Mat& image, cv::Size size) {
  const auto difference = [](const cv::Mat& a, const cv::Mat& b) {
    return a.type() == b.type() && a.size() == b.size() ? cv::norm(a, b, cv::NORM_INF) : -1;
  };
  EXPECT_EQ(difference(ShrinkArea(image, size), OpenCvs(image, size, cv::INTER_AREA)), 0)
      << "area: " << image.size() << " to " << size << ", channels " << image.channels();
  EXPECT_EQ(difference(ShrinkLinear(image, size), OpenCvs(image, size, cv::INTER_LINEAR)), 0)
      << "linear: " << image.size() << " to " << size << ", channels " << image.channels();
}

// Sizes of recordings and of the pyramid, whole factors, and images that get larger.
TEST(Shrink, OfUsualSizesIsOpenCvsBitForBit) {
  Random random(4);
  const cv::Size sizes[][2] = {
      {{640, 480}, {400, 300}},  {{640, 480}, {533, 400}},   {{533, 400}, {444, 333}},
      {{640, 480}, {240, 180}},  {{400, 300}, {240, 180}},   {{752, 480}, {400, 255}},
      {{1280, 720}, {400, 225}}, {{1920, 1080}, {400, 225}}, {{1241, 376}, {240, 73}},
      {{800, 600}, {400, 300}},  {{640, 480}, {320, 300}},   {{320, 240}, {400, 300}},
      {{320, 300}, {300, 400}},  {{1920, 1080}, {240, 135}}};
  for (const auto& [from, to] : sizes) {
    for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4}) ExpectTheSame(Noise(from, type, random), to);
  }
}

TEST(Shrink, OfAnySizeIsOpenCvsBitForBit) {
  Random random(5);
  for (int trial = 0; trial < 3000; ++trial) {
    const auto side = [&](int most) { return 1 + static_cast<int>(random.Below(most)); };
    const cv::Size from(side(120), side(60));
    const cv::Size to(side(from.width), side(from.height));
    const int channels = 1 + static_cast<int>(random.Below(4));
    ExpectTheSame(Noise(from, CV_MAKETYPE(CV_8U, channels), random), to);
  }
}

TEST(Shrink, KeepsTheEndsOfTheScale) {
  for (const int value : {0, 1, 254, 255}) {
    const cv::Mat image(97, 131, CV_8UC1, cv::Scalar(value));
    ExpectTheSame(image, {83, 61});
    EXPECT_EQ(cv::countNonZero(ShrinkArea(image, {83, 61}) != value), 0);
  }
}

}  // namespace
}  // namespace alidade::shrink_test
