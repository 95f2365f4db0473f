#include "alidade/detect/letterbox.h"

#include <gtest/gtest.h>

#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/detect/network_input.h"

namespace alidade::letterbox_test {
namespace {

cv::Mat Noise(cv::Size size, int type) {
  cv::Mat image(size, type);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

TEST(Letterbox, LeavesAnImageOfTheInputsSizeAlone) {
  const Letterbox letterbox = FitInto({640, 480}, {640, 480});
  EXPECT_EQ(letterbox.inner, cv::Size(640, 480));
  const cv::Mat image = Noise({640, 480}, CV_8UC3);
  EXPECT_EQ(Apply(letterbox, image).data, image.data);
  EXPECT_EQ(ToImage(letterbox, {10, 20, 30, 40}), cv::Rect2f(10, 20, 30, 40));
}

TEST(Letterbox, KeepsTheShapeAndFillsBothSidesEqually) {
  const Letterbox wide = FitInto({640, 480}, {640, 640});  // 80 rows above and below
  EXPECT_EQ(wide.inner, cv::Size(640, 480));
  EXPECT_EQ(wide.pad_left, 0);
  EXPECT_EQ(wide.pad_top, 80);
  // Halved: 240 × 480, 200 columns on each side.
  const Letterbox tall = FitInto({480, 960}, {640, 480});
  EXPECT_EQ(tall.inner, cv::Size(240, 480));
  EXPECT_EQ(tall.pad_left, 200);
  EXPECT_EQ(tall.pad_top, 0);
  EXPECT_EQ(FitInto({1, 1000}, {64, 32}).inner, cv::Size(1, 32));
}

TEST(Letterbox, PutsTheImageBetweenGreyMargins) {
  const cv::Mat image = Noise({64, 32}, CV_8UC3);
  const cv::Mat fitted = Apply(FitInto({64, 32}, {32, 32}), image);
  ASSERT_EQ(fitted.size(), cv::Size(32, 32));
  cv::Mat half;
  cv::resize(image, half, {32, 16}, 0, 0, cv::INTER_LINEAR);
  EXPECT_EQ(cv::norm(fitted.rowRange(8, 24), half, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(fitted.rowRange(0, 8) - cv::Scalar::all(114), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(fitted.rowRange(24, 32) - cv::Scalar::all(114), cv::NORM_INF), 0);
}

TEST(Letterbox, TakesGreyForThreeEqualChannels) {
  const cv::Mat grey = Noise({40, 30}, CV_8UC1);
  cv::Mat color;
  cv::cvtColor(grey, color, cv::COLOR_GRAY2BGR);
  const Letterbox letterbox = FitInto({40, 30}, {64, 64});
  EXPECT_EQ(cv::norm(Apply(letterbox, grey), Apply(letterbox, color), cv::NORM_INF), 0);
}

TEST(Letterbox, BringsBoxesBackClippedToTheImage) {
  const Letterbox letterbox = FitInto({1280, 960}, {640, 640});
  EXPECT_EQ(ToImage(letterbox, {100, 180, 50, 100}), cv::Rect2f(200, 200, 100, 200));
  EXPECT_EQ(ToImage(letterbox, {-20, 60, 40, 40}), cv::Rect2f(0, 0, 40, 40));
  EXPECT_EQ(ToImage(letterbox, {0, 0, 640, 640}), cv::Rect2f(0, 0, 1280, 960));
}

TEST(Letterbox, DropsBoxesOfNoSize) {
  const Letterbox letterbox = FitInto({640, 480}, {640, 640});
  EXPECT_FALSE(ToImage(letterbox, {10, 10, 30, 60}));     // completely in the margin
  EXPECT_FALSE(ToImage(letterbox, {10, 100, 1.5f, 60}));  // less than 2 pixels wide
  EXPECT_FALSE(ToImage(letterbox, {10, 100, -20, 60}));
  EXPECT_FALSE(ToImage(letterbox, {700, 100, 20, 60}));
  EXPECT_TRUE(ToImage(letterbox, {10, 78.5f, 30, 4}));  // 2.5 of its rows are in the image
}

TEST(Letterbox, RefusesEmptyImages) {
  EXPECT_THROW(FitInto({0, 0}, {640, 480}), Error);
  EXPECT_THROW(FitInto({640, 480}, {640, 0}), Error);
}

TEST(NetworkInput, AgreesWithOpenCv) {
  const cv::Mat picture = Noise({96, 64}, CV_8UC3);
  for (const bool red_first : {true, false}) {
    const cv::Mat theirs = cv::dnn::blobFromImage(picture, 1 / 255.0, {}, {}, red_first, false);
    const cv::Mat ours = ToNetworkInput(picture, {.red_first = red_first, .scale = 1.0f / 255});
    ASSERT_EQ(ours.size, theirs.size);
    EXPECT_LE(cv::norm(ours.reshape(1, 1), theirs.reshape(1, 1), cv::NORM_INF), 1e-6);
  }
}

}  // namespace
}  // namespace alidade::letterbox_test
