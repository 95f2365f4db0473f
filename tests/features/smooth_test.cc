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

}  // namespace
}  // namespace alidade::smooth_test
