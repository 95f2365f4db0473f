#include "alidade/io/camera/pixel_format.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

namespace alidade {
namespace {

constexpr std::array kFormats = {
    PixelFormat{"GREY", V4L2_PIX_FMT_GREY, 8, false},
    PixelFormat{"NV12", V4L2_PIX_FMT_NV12, 12, true},
    PixelFormat{"YUYV", V4L2_PIX_FMT_YUYV, 16, true},
    PixelFormat{"UYVY", V4L2_PIX_FMT_UYVY, 16, true},
    PixelFormat{"Y16", V4L2_PIX_FMT_Y16, 16, false},
    PixelFormat{"MJPEG", V4L2_PIX_FMT_MJPEG, 0, true},
    PixelFormat{"JPEG", V4L2_PIX_FMT_JPEG, 0, true},
};

// The rows of an image in the driver's buffer, which is not copied. Empty: there are too few bytes.
cv::Mat View(std::string_view bytes, cv::Size size, int type, size_t stride) {
  const size_t row = static_cast<size_t>(size.width) * CV_ELEM_SIZE(type);
  if (stride == 0) stride = row;
  if (stride < row || size.empty() ||
      bytes.size() < stride * (static_cast<size_t>(size.height) - 1) + row)
    return {};
  return cv::Mat(size, type, const_cast<char*>(bytes.data()), stride);
}

// Y and, for every second pixel, U or V.
DecodedImage Packed(const cv::Mat& yuv, int luma, cv::ColorConversionCodes conversion, bool color) {
  DecodedImage decoded;
  cv::extractChannel(yuv, decoded.image, luma);
  if (color) cv::cvtColor(yuv, decoded.color, conversion);
  return decoded;
}

// A plane of Y, then one of U and V of half the size.
DecodedImage Planar(std::string_view bytes, cv::Size size, size_t stride, bool color) {
  const cv::Mat luma = View(bytes, size, CV_8UC1, stride);
  if (luma.empty()) return {{}, "is incomplete"};
  DecodedImage decoded;
  decoded.image = luma.clone();
  if (!color) return decoded;
  const size_t start = luma.step[0] * static_cast<size_t>(size.height);
  const cv::Size half(size.width / 2, size.height / 2);
  const cv::Mat chroma =
      View(bytes.substr(std::min(start, bytes.size())), half, CV_8UC2, luma.step[0]);
  if (!chroma.empty() && size.width % 2 == 0 && size.height % 2 == 0)
    cv::cvtColorTwoPlane(luma, chroma, decoded.color, cv::COLOR_YUV2BGR_NV12);
  return decoded;
}

}  // namespace

const PixelFormat* FindPixelFormat(std::string_view name) {
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                   [&](const PixelFormat& format) { return name == format.name; });
  return found == kFormats.end() ? nullptr : found;
}

const PixelFormat* FindPixelFormat(uint32_t code) {
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                   [&](const PixelFormat& format) { return code == format.code; });
  return found == kFormats.end() ? nullptr : found;
}

int PreferenceOf(const PixelFormat& format) {
  return static_cast<int>(FindPixelFormat(format.code) - kFormats.data());
}

std::string NamesOfPixelFormats() {
  std::string names;
  for (const PixelFormat& format : kFormats)
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  return names;
}

DecodedImage DecodePixels(const PixelFormat& format, cv::Size size, size_t stride,
                          std::string_view bytes, bool color) {
  if (format.bits == 0) {
    DecodedImage decoded = DecodeJpeg(bytes, color ? ImageUse::kGrayAndColor : ImageUse::kGray);
    if (decoded.problem.empty() && decoded.image.size() != size)
      return {{}, "has another size than the camera's images"};
    return decoded;
  }
  if (format.code == V4L2_PIX_FMT_NV12) return Planar(bytes, size, stride, color);
  const bool wide = format.code == V4L2_PIX_FMT_Y16;
  const int type = wide ? CV_16UC1 : format.bits == 8 ? CV_8UC1 : CV_8UC2;
  const cv::Mat pixels = View(bytes, size, type, stride);
  if (pixels.empty()) return {{}, "is incomplete"};
  if (format.code == V4L2_PIX_FMT_YUYV) return Packed(pixels, 0, cv::COLOR_YUV2BGR_YUYV, color);
  if (format.code == V4L2_PIX_FMT_UYVY) return Packed(pixels, 1, cv::COLOR_YUV2BGR_UYVY, color);
  return {pixels.clone(), {}};
}

}  // namespace alidade
