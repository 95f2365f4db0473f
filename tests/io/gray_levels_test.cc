#include "alidade/io/gray_levels.h"

#include <gtest/gtest.h>

#include "alidade/io/files/image_file.h"
#include "support/temp_folder.h"

namespace alidade::gray_levels_test {
namespace {

// A texture of 8 bits as `scale` times its values plus `offset` in 16 bits.
cv::Mat Wide(const cv::Mat& gray, double scale, double offset) {
  cv::Mat wide;
  gray.convertTo(wide, CV_16U, scale, offset);
  return wide;
}

cv::Mat Texture() {
  cv::Mat image(120, 160, CV_8UC1);
  cv::RNG random(4);
  random.fill(image, cv::RNG::UNIFORM, 20, 230);
  return image;
}

double Contrast(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0];
}

TEST(GrayLevels, OfTenAndTwelveBitsAndThermalImagesAreStretched) {
  const cv::Mat gray = Texture();
  for (const auto& [scale, offset] : {std::pair{4.0, 0.0}, {16.0, 0.0}, {8.0, 28500.0}}) {
    GrayLevels levels;
    const cv::Mat image = levels.To8Bit(Wide(gray, scale, offset), 0);
    EXPECT_EQ(image.type(), CV_8UC1);
    EXPECT_NEAR(Contrast(image), Contrast(gray), 0.15 * Contrast(gray)) << scale;
  }
}

TEST(GrayLevels, OfAllSixteenBitsKeepTheUpperEight) {
  const cv::Mat gray = Texture();
  GrayLevels levels;
  EXPECT_EQ(cv::norm(levels.To8Bit(Wide(gray, 257, 0), 0), gray, cv::NORM_INF), 0);
  EXPECT_EQ(levels.range()->white, 65535);
}

TEST(GrayLevels, AreLearnedInTheFirstSecondAndKept) {
  const cv::Mat gray = Texture();
  GrayLevels levels;
  levels.To8Bit(Wide(gray, 4, 0), 10);
  const double white = levels.range()->white;
  levels.To8Bit(Wide(gray, 6, 0), 10.5);
  EXPECT_GT(levels.range()->white, 1.2 * white);
  const double kept = levels.range()->white;
  levels.To8Bit(Wide(gray, 12, 0), 11.5);
  EXPECT_EQ(levels.range()->white, kept);
  EXPECT_EQ(levels.To8Bit(gray, 12).data, gray.data) << "8 bits are left as they are";
}

TEST(GrayLevels, OfAnImageWithoutStructureAreNotNoise) {
  GrayLevels levels;
  cv::Mat flat(120, 160, CV_16UC1, cv::Scalar(500));
  cv::Mat noise(flat.size(), CV_16SC1);
  cv::randn(noise, 0, 1.5);
  cv::add(flat, noise, flat, cv::noArray(), CV_16U);
  EXPECT_LT(Contrast(levels.To8Bit(flat, 0)), 8);
}

TEST(GrayLevels, FilesAreReadWithTheBitsTheyHave) {
  const TempFolder folder;
  const cv::Mat wide = Wide(Texture(), 4, 0);
  WriteImage(folder / "a.png", wide);
  EXPECT_EQ(cv::norm(ReadImageAsStored(folder / "a.png", false).gray, wide, cv::NORM_INF), 0);
  EXPECT_EQ(ReadImageGray(folder / "a.png").type(), CV_8UC1);
}

}  // namespace
}  // namespace alidade::gray_levels_test
