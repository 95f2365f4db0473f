// Encodes and decodes images. A `problem` is a message for users without the file's name.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace alidade {

enum class ImageUse { kGray, kColor, kDepth, kGrayAndColor };

struct DecodedImage {
  // kGray, kGrayAndColor: CV_8UC1, or CV_16UC1 of a gray image with 16 bits. kColor: CV_8UC3.
  // kDepth: CV_16UC1 or CV_32FC1.
  cv::Mat image;
  std::string problem;  // why there is no image; empty: no problem
  // Only with kGrayAndColor, when `image` is the gray one: CV_8UC3, blue green red; empty for a
  // gray file. CV_16UC3 in messages of ROS with as many bits.
  cv::Mat color = {};
};

inline constexpr char kDepthOf8Bits[] = "has 8 bits: depth needs 16, or floating point";

// Detects the format by the first bytes: JPEG, PNG, or a format of the media module.
DecodedImage DecodeImageBytes(std::string_view bytes, ImageUse use);

bool LooksLikeJpeg(std::string_view bytes);
bool LooksLikePng(std::string_view bytes);
DecodedImage DecodeJpeg(std::string_view bytes, ImageUse use);
DecodedImage DecodePng(std::string_view bytes, ImageUse use);
cv::Size JpegSize(std::string_view bytes);  // 0 x 0 when the header cannot be read
cv::Size PngSize(std::string_view bytes);

std::string EncodeJpeg(const cv::Mat& image, int quality);
std::string EncodePng(const cv::Mat& image);

}  // namespace alidade
