#include "alidade/features/color.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace alidade::color_test {
namespace {

// A part of a larger image, so that rows are not contiguous.
cv::Mat RandomImage(int type) {
  cv::Mat image(40, 61, type);
  cv::theRNG().state = 7;
  cv::randu(image, 0, 256);
  return image(cv::Rect(3, 2, 53, 31));
}

cv::Mat Converted(const cv::Mat& image, int code) {
  cv::Mat converted;
  cv::cvtColor(image, converted, code);
  return converted;
}

void ExpectSame(const cv::Mat& a, const cv::Mat& b) {
  ASSERT_EQ(a.type(), b.type());
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0);
}

TEST(Color, IsTheBytesOfCvtColor) {
  const cv::Mat gray = RandomImage(CV_8UC1), three = RandomImage(CV_8UC3),
                four = RandomImage(CV_8UC4);
  ExpectSame(GrayOf(three), Converted(three, cv::COLOR_BGR2GRAY));
  ExpectSame(GrayOf(four), Converted(four, cv::COLOR_BGRA2GRAY));
  ExpectSame(GrayOf(four, true), Converted(four, cv::COLOR_RGBA2GRAY));
  ExpectSame(BgrOf(gray), Converted(gray, cv::COLOR_GRAY2BGR));
  ExpectSame(BgrOf(four), Converted(four, cv::COLOR_BGRA2BGR));
  ExpectSame(BgrOf(four, true), Converted(four, cv::COLOR_RGBA2BGR));
}

}  // namespace
}  // namespace alidade::color_test
