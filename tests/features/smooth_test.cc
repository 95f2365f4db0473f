#include "alidade/features/smooth.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "support/texture.h"

namespace alidade::smooth_test {
namespace {

TEST(SmoothBinomial, IsOpenCvsFilterWithWeights121) {
  for (cv::Size size :
       {cv::Size(101, 40), cv::Size(16, 16), cv::Size(17, 5), cv::Size(7, 3), cv::Size(1, 1)}) {
    const cv::Mat large = MakeTexture(size.width + 9, size.height + 9, 3);
    const cv::Mat image = large(cv::Rect(cv::Point(4, 3), size));
    cv::Mat ours(size, CV_8UC1), theirs;
    SmoothBinomial(image, 0, ours);
    const cv::Mat weights = (cv::Mat_<double>(3, 1) << 0.25, 0.5, 0.25);
    cv::sepFilter2D(image, theirs, CV_32F, weights, weights, cv::Point(-1, -1), 0,
                    cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
    cv::Mat ours_float;
    ours.convertTo(ours_float, CV_32F);
    EXPECT_LE(cv::norm(ours_float, theirs, cv::NORM_INF), 0.5) << size;
  }
}

TEST(SmoothBox, IsOpenCvsMeanOver5x5) {
  for (cv::Size size :
       {cv::Size(101, 40), cv::Size(16, 16), cv::Size(17, 5), cv::Size(7, 3), cv::Size(1, 1)}) {
    const cv::Mat image = MakeTexture(size.width, size.height, 4);
    cv::Mat ours(size, CV_8UC1), theirs, ours_float;
    SmoothBox(image, 0, ours);
    cv::Mat image_float;
    image.convertTo(image_float, CV_32F, 250.0 / 256);
    cv::blur(image_float, theirs, cv::Size(5, 5), cv::Point(-1, -1), cv::BORDER_REPLICATE);
    ours.convertTo(ours_float, CV_32F);
    // SmoothBox() rounds down
    EXPECT_LE(cv::norm(ours_float, theirs, cv::NORM_INF), 1.001) << size;
  }
}

TEST(Smooth, OfABandIsThatPartOfTheWhole) {
  const cv::Mat image = MakeTexture(90, 60, 5);
  cv::Mat whole(60, 90, CV_8UC1), band(20, 90, CV_8UC1);
  SmoothBinomial(image, 0, whole);
  SmoothBinomial(image, 30, band);
  EXPECT_EQ(cv::norm(band, whole.rowRange(30, 50), cv::NORM_INF), 0);
  SmoothBox(image, 0, whole);
  SmoothBox(image, 40, band);
  EXPECT_EQ(cv::norm(band, whole.rowRange(40, 60), cv::NORM_INF), 0);
}

// However many columns are computed at once: strips have fewer than any vector holds.
TEST(Smooth, OfAStripIsThatPartOfTheWhole) {
  const cv::Mat image = MakeTexture(203, 60, 6);
  cv::Mat binomial(image.size(), CV_8UC1), box(image.size(), CV_8UC1);
  SmoothBinomial(image, 0, binomial);
  SmoothBox(image, 0, box);
  constexpr int kWidth = 11, kRim = 2;
  for (int x = 0; x + kWidth <= image.cols; x += kWidth - 2 * kRim) {
    cv::Mat strip(image.rows, kWidth, CV_8UC1);
    const int left = x == 0 ? 0 : kRim, right = x + kWidth == image.cols ? kWidth : kWidth - kRim;
    const auto differs = [&](const cv::Mat& whole) {
      return cv::norm(strip.colRange(left, right), whole.colRange(x + left, x + right),
                      cv::NORM_INF);
    };
    const cv::Mat part = image.colRange(x, x + kWidth);
    SmoothBinomial(part, 0, strip);
    EXPECT_EQ(differs(binomial), 0) << x;
    SmoothBox(part, 0, strip);
    EXPECT_EQ(differs(box), 0) << x;
  }
}

}  // namespace
}  // namespace alidade::smooth_test
