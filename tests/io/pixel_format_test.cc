#include "alidade/io/camera/pixel_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <opencv2/imgproc.hpp>

namespace alidade::pixel_format_test {
namespace {

constexpr int kWidth = 16, kHeight = 6;

// Level of a pixel.
int At(int x, int y) { return 10 + 7 * x + 11 * y; }

// Rows of `bytes` each, followed by `gap` bytes that are no part of the image.
std::string Rows(int rows, int bytes, int gap, const std::function<int(int, int)>& value) {
  std::string text;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < bytes; ++x) text += static_cast<char>(value(x, y));
    text += std::string(static_cast<size_t>(gap), '\xee');
  }
  return text;
}

void ExpectLevels(const cv::Mat& image) {
  ASSERT_EQ(image.size(), cv::Size(kWidth, kHeight));
  ASSERT_EQ(image.type(), CV_8UC1);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) EXPECT_EQ(image.at<uchar>(y, x), At(x, y));
}

DecodedImage Decode(uint32_t code, size_t stride, std::string_view bytes, bool color = false) {
  return DecodePixels(*FindPixelFormat(code), {kWidth, kHeight}, stride, bytes, color);
}

TEST(PixelFormat, ReadsGrayRowsWithGaps) {
  for (const int gap : {0, 48})
    ExpectLevels(Decode(V4L2_PIX_FMT_GREY, static_cast<size_t>(gap > 0 ? kWidth + gap : 0),
                        Rows(kHeight, kWidth, gap, At))
                     .image);
}

TEST(PixelFormat, ReadsTheLumaOfPackedAndPlanarColors) {
  for (const bool luma_first : {true, false}) {
    const std::string bytes = Rows(kHeight, 2 * kWidth, 4, [&](int x, int y) {
      return (x % 2 == 0) == luma_first ? At(x / 2, y) : 128;
    });
    const DecodedImage decoded =
        Decode(luma_first ? V4L2_PIX_FMT_YUYV : V4L2_PIX_FMT_UYVY, 2 * kWidth + 4, bytes, true);
    ExpectLevels(decoded.image);
    ASSERT_EQ(decoded.color.type(), CV_8UC3);
    const auto pixel = decoded.color.at<cv::Vec3b>(3, 5);  // gray: its chroma is 128
    EXPECT_EQ(pixel[0], pixel[1]);
    EXPECT_EQ(pixel[1], pixel[2]);
  }
  const std::string planes =
      Rows(kHeight, kWidth, 0, At) + Rows(kHeight / 2, kWidth, 0, [](int, int) { return 128; });
  const DecodedImage decoded = Decode(V4L2_PIX_FMT_NV12, 0, planes, true);
  ExpectLevels(decoded.image);
  EXPECT_EQ(decoded.color.size(), cv::Size(kWidth, kHeight));
}

TEST(PixelFormat, KeepsSixteenBits) {
  const std::string bytes = Rows(kHeight, 2 * kWidth, 0, [](int x, int y) {
    const int level = 257 * At(x / 2, y);
    return x % 2 == 0 ? level & 255 : level >> 8;
  });
  const cv::Mat image = Decode(V4L2_PIX_FMT_Y16, 0, bytes).image;
  ASSERT_EQ(image.type(), CV_16UC1);
  EXPECT_EQ(image.at<uint16_t>(2, 7), 257 * At(7, 2));
}

// Cameras leave the Huffman tables of their JPEG images out.
TEST(PixelFormat, ReadsMotionJpegWithoutTables) {
  cv::Mat gray(64, 96, CV_8UC1);
  cv::randu(gray, 60, 190);
  cv::GaussianBlur(gray, gray, {}, 3);
  std::string bytes = EncodeJpeg(gray, 95);
  const PixelFormat& format = *FindPixelFormat(std::string_view("MJPEG"));
  const cv::Mat whole = DecodePixels(format, gray.size(), 0, bytes, false).image;
  ASSERT_FALSE(whole.empty());
  int removed = 0;
  for (size_t at = 2; at + 4 < bytes.size() && bytes[at] == '\xff' && bytes[at + 1] != '\xda';) {
    const size_t size = 2 + 256 * static_cast<size_t>(static_cast<uchar>(bytes[at + 2])) +
                        static_cast<uchar>(bytes[at + 3]);
    if (bytes[at + 1] == '\xc4') {
      bytes.erase(at, size);
      ++removed;
    } else {
      at += size;
    }
  }
  EXPECT_GT(removed, 0);
  const DecodedImage decoded = DecodePixels(format, gray.size(), 0, bytes, true);
  ASSERT_TRUE(decoded.problem.empty()) << decoded.problem;
  EXPECT_EQ(cv::norm(decoded.image, whole, cv::NORM_INF), 0);
}

TEST(PixelFormat, IncompleteImagesAreToldAndNotRead) {
  for (const uint32_t code : {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_UYVY,
                              V4L2_PIX_FMT_Y16, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_MJPEG}) {
    for (const size_t bytes : {0, 1, 50, kWidth * kHeight - 1}) {
      const DecodedImage decoded = Decode(code, 0, std::string(bytes, '\x55'), true);
      EXPECT_TRUE(decoded.image.empty());
      EXPECT_FALSE(decoded.problem.empty());
    }
    EXPECT_FALSE(Decode(code, 3, std::string(4000, '\x55')).problem.empty());  // stride < row
  }
}

}  // namespace
}  // namespace alidade::pixel_format_test
