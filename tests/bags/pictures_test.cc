// Encodings of images and depth, compared with explicit conversions.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "alidade/io/ros/messages/picture_of_message.h"
#include "bags/message_bytes.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::pictures_test {
namespace {

using testing::HasSubstr;

constexpr Dialect kRos1{false};

DecodedImage Decoded(const std::string& encoding, cv::Size size, const std::string& rows,
                     ImageUse use = ImageUse::kGrayAndColor) {
  const std::string message = ImageMessage(kRos1, 5, "camera", encoding, size, rows);
  return PictureOf(ParseRosPicture(message, Serialization::kRos1, false), use);
}
DecodedImage Decoded(const std::string& encoding, const cv::Mat& image,
                     ImageUse use = ImageUse::kGrayAndColor) {
  return Decoded(encoding, image.size(), BytesOf(image), use);
}

int Farthest(const cv::Mat& a, const cv::Mat& b) {
  EXPECT_EQ(a.size(), b.size());
  EXPECT_EQ(a.type(), b.type());
  return a.size() == b.size() && a.type() == b.type()
             ? static_cast<int>(cv::norm(a, b, cv::NORM_INF))
             : 999;
}

// The three channels have different gradients, so that a swap is detected.
cv::Mat Slopes() {
  cv::Mat image(48, 64, CV_8UC3);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x)
      image.at<cv::Vec3b>(y, x) = {static_cast<uchar>(40 + x), static_cast<uchar>(200 - 2 * y),
                                   static_cast<uchar>(3 * x)};
  }
  return image;
}

cv::Mat GreyOf(const cv::Mat& color) {
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

TEST(RosPictures, OfEightBitsAChannelComeOutExactly) {
  const cv::Mat color = Slopes(), gray = GreyOf(color);
  const auto check = [&](const std::string& encoding, int code) {
    cv::Mat stored = color.clone();
    if (code >= 0) cv::cvtColor(color, stored, code);
    const DecodedImage decoded = Decoded(encoding, stored);
    EXPECT_EQ(Farthest(decoded.image, gray), 0) << encoding;
    EXPECT_EQ(Farthest(decoded.color, color), 0) << encoding;
  };
  check("bgr8", -1);
  check("8UC3", -1);
  check("rgb8", cv::COLOR_BGR2RGB);
  check("bgra8", cv::COLOR_BGR2BGRA);
  check("rgba8", cv::COLOR_BGR2RGBA);
  EXPECT_EQ(Farthest(Decoded("mono8", gray).image, gray), 0);
  EXPECT_EQ(Farthest(Decoded("8UC1", gray).image, gray), 0);
  EXPECT_TRUE(Decoded("mono8", gray).color.empty());
}

// Pixels by the pattern's definition: its letters are the first two pixels of the first two rows.
TEST(RosPictures, OfBayerPatternsHaveTheirColours) {
  const cv::Mat color = Slopes();
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    cv::Mat raw(color.size(), CV_8UC1);
    for (int y = 0; y < raw.rows; ++y) {
      for (int x = 0; x < raw.cols; ++x) {
        const char letter = pattern[static_cast<size_t>(2 * (y % 2) + x % 2)];
        raw.at<uchar>(y, x) = color.at<cv::Vec3b>(y, x)[letter == 'b' ? 0 : letter == 'g' ? 1 : 2];
      }
    }
    const DecodedImage decoded = Decoded("bayer_" + pattern + "8", raw);
    const cv::Rect inside(4, 4, 56, 40);  // gradients are interpolated exactly except for rounding
    EXPECT_LE(Farthest(decoded.color(inside), color(inside)), 2) << pattern;
    EXPECT_LE(Farthest(decoded.image(inside), GreyOf(color)(inside)), 3) << pattern;
  }
}

TEST(RosPictures, OfBrightnessAndColourHaveTheirBrightness) {
  const cv::Mat y = GreyOf(Slopes());
  std::string uyvy, yuy2;
  for (int row = 0; row < y.rows; ++row) {
    for (int x = 0; x < y.cols; ++x) {
      const char brightness = static_cast<char>(y.at<uchar>(row, x));
      uyvy += std::string({static_cast<char>(128), brightness});
      yuy2 += std::string({brightness, static_cast<char>(128)});
    }
  }
  EXPECT_EQ(Farthest(Decoded("yuv422", y.size(), uyvy).image, y), 0);
  EXPECT_EQ(Farthest(Decoded("uyvy", y.size(), uyvy).image, y), 0);
  EXPECT_EQ(Farthest(Decoded("yuv422_yuy2", y.size(), yuy2).image, y), 0);
  MessageBytes nv12(false);
  nv12.Header(5, "camera").U32(48).U32(64).Text("nv12").U8(0).U32(64);
  const std::string message =
      nv12.Bytes(BytesOf(y) + std::string(48 * 64 / 2, static_cast<char>(128))).Done();
  const DecodedImage decoded =
      PictureOf(ParseRosPicture(message, Serialization::kRos1, false), ImageUse::kGrayAndColor);
  EXPECT_EQ(Farthest(decoded.image, y), 0);
  EXPECT_EQ(decoded.color.size(), y.size());
}

TEST(RosPictures, OfSixteenBitsAreScaled) {
  const cv::Mat raw(48, 64, CV_16UC1, cv::Scalar(257 * 77));
  EXPECT_EQ(Decoded("mono16", raw).image.at<uchar>(3, 3), 77);
}

TEST(RosPictures, HaveRowsWithPaddingAndBigEndianDepth) {
  MessageBytes padded(false);
  padded.Header(5, "c").U32(2).U32(2).Text("mono8").U8(0).U32(4);
  const std::string rows("\1\2xx\3\4xx", 8);
  const RosPicture picture = {{5, "c"}, false, "mono8", 2, 2, 4, false, rows};
  EXPECT_EQ(PictureOf(picture, ImageUse::kGray).image.at<uchar>(1, 1), 4);
  // The padding of the last row may be missing.
  const RosPicture exact = {{5, "c"}, false, "mono8", 2,
                            2,        4,     false,   std::string_view(rows).substr(0, 6)};
  EXPECT_EQ(PictureOf(exact, ImageUse::kGray).image.at<uchar>(1, 0), 3);
  const RosPicture big = {{5, "c"}, false, "16UC1", 1, 1, 2, true, std::string_view("\x03\xe8", 2)};
  EXPECT_EQ(PictureOf(big, ImageUse::kDepth).image.at<uint16_t>(0, 0), 1000);
}

TEST(RosPictures, OfDepthAreMillimetresOrMetres) {
  const cv::Mat metres(48, 64, CV_32FC1, cv::Scalar(2.5f));
  EXPECT_EQ(Decoded("32FC1", metres, ImageUse::kDepth).image.at<float>(1, 2), 2.5f);
  EXPECT_EQ(Farthest(Decoded("16UC1", TinyDepth(7), ImageUse::kDepth).image, TinyDepth(7)), 0);
  MessageOf(ErrorKind::kInput, [&] { Decoded("32FC1", metres, ImageUse::kGray); });
  MessageOf(ErrorKind::kInput, [&] { Decoded("bgr8", Slopes(), ImageUse::kDepth); });
}

TEST(RosPictures, OfCompressedDepthAreUnpacked) {
  const auto decode = [](const std::string& format, const std::string& data) {
    const std::string message = CompressedMessage(kRos1, 5, "camera", format, data);
    return PictureOf(ParseRosPicture(message, Serialization::kRos1, true), ImageUse::kDepth).image;
  };
  const std::string png = EncodePng(TinyDepth(0));
  EXPECT_EQ(
      Farthest(decode("16UC1; compressedDepth png", std::string(12, '\0') + png), TinyDepth(0)), 0);
  EXPECT_EQ(Farthest(decode("16UC1; png compressed ", png), TinyDepth(0)), 0);
  // v = a / z + b with a = 2000, b = 200: 1000 means 2.5 m.
  const float quantization[] = {2000, 200};
  std::string head(4, '\0');
  head.append(reinterpret_cast<const char*>(quantization), sizeof quantization);
  EXPECT_FLOAT_EQ(decode("32FC1; compressedDepth png", head + png).at<float>(0, 0), 2.5f);
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [&] { decode("16UC1; compressedDepth zstd", head + "xxxxxxxx"); }),
              HasSubstr("`16UC1; compressedDepth zstd`, which is not read"));
}

TEST(RosPictures, ThatCannotBeAreRefused) {
  const cv::Mat gray = GreyOf(Slopes());
  const auto message = [](const RosPicture& picture) {
    return MessageOf(ErrorKind::kInput, [&] { PictureOf(picture, ImageUse::kGray); });
  };
  EXPECT_THAT(message({{}, false, "mono8", 64, 48, 64, false, "short"}), HasSubstr("truncated"));
  EXPECT_THAT(message({{}, false, "mono8", 64, 48, 3, false, "short"}), HasSubstr("truncated"));
  EXPECT_THAT(message({{}, false, "mono8", 70000, 70000, 0, false, ""}), HasSubstr("too large"));
  EXPECT_THAT(message({{}, false, "mono8", 0, 0, 0, false, ""}), HasSubstr("too large"));
  EXPECT_THAT(message({{}, true, "jpeg", 0, 0, 0, false, "\xff\xd8\xff"}), HasSubstr("JPEG"));
}

}  // namespace
}  // namespace alidade::pictures_test
