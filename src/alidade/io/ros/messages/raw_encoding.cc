#include "alidade/io/ros/messages/raw_encoding.h"

#include <algorithm>
#include <bit>
#include <map>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"

namespace alidade {
namespace {

// Conversion of an encoding of sensor_msgs/image_encodings to gray and to color.
struct RawEncoding {
  int type;      // OpenCV type of the message's pixels
  int to_gray;   // cvtColor code; kAsIs: already gray
  int to_color;  // cvtColor code to blue green red; kAsIs: already that; kNone: no color
};
// kPlanar444: luma, then all pairs of chroma, which cvtColor() does not know.
constexpr int kAsIs = -1, kNone = -2, kPlanar444 = -3;

// ROS names a Bayer pattern by the top-left 2 x 2 pixels, OpenCV by the second row starting at the
// second column. So the same pattern has different names.
const std::map<std::string, RawEncoding>& RawEncodings() {
  static const std::map<std::string, RawEncoding> encodings = {
      {"mono8", {CV_8UC1, kAsIs, kNone}},
      {"8UC1", {CV_8UC1, kAsIs, kNone}},
      {"mono16", {CV_16UC1, kAsIs, kNone}},
      {"16UC1", {CV_16UC1, kAsIs, kNone}},
      {"32FC1", {CV_32FC1, kNone, kNone}},
      {"bgr8", {CV_8UC3, cv::COLOR_BGR2GRAY, kAsIs}},
      {"8UC3", {CV_8UC3, cv::COLOR_BGR2GRAY, kAsIs}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2GRAY, cv::COLOR_RGB2BGR}},
      {"bgra8", {CV_8UC4, cv::COLOR_BGRA2GRAY, cv::COLOR_BGRA2BGR}},
      {"8UC4", {CV_8UC4, cv::COLOR_BGRA2GRAY, cv::COLOR_BGRA2BGR}},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2GRAY, cv::COLOR_RGBA2BGR}},
      {"bgr16", {CV_16UC3, cv::COLOR_BGR2GRAY, kAsIs}},
      {"16UC3", {CV_16UC3, cv::COLOR_BGR2GRAY, kAsIs}},
      {"rgb16", {CV_16UC3, cv::COLOR_RGB2GRAY, cv::COLOR_RGB2BGR}},
      {"bgra16", {CV_16UC4, cv::COLOR_BGRA2GRAY, cv::COLOR_BGRA2BGR}},
      {"16UC4", {CV_16UC4, cv::COLOR_BGRA2GRAY, cv::COLOR_BGRA2BGR}},
      {"rgba16", {CV_16UC4, cv::COLOR_RGBA2GRAY, cv::COLOR_RGBA2BGR}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2GRAY, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2GRAY, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2GRAY, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2GRAY, cv::COLOR_BayerGB2BGR}},
      {"bayer_rggb16", {CV_16UC1, cv::COLOR_BayerBG2GRAY, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr16", {CV_16UC1, cv::COLOR_BayerRG2GRAY, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg16", {CV_16UC1, cv::COLOR_BayerGR2GRAY, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg16", {CV_16UC1, cv::COLOR_BayerGB2GRAY, cv::COLOR_BayerGB2BGR}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2GRAY_UYVY, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2GRAY_UYVY, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2GRAY_YUY2, cv::COLOR_YUV2BGR_YUY2}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2GRAY_YUY2, cv::COLOR_YUV2BGR_YUY2}},
      // All rows of luma, followed by half as many rows of chroma.
      {"nv12", {CV_8UC1, cv::COLOR_YUV2GRAY_NV12, cv::COLOR_YUV2BGR_NV12}},
      {"nv21", {CV_8UC1, cv::COLOR_YUV2GRAY_NV21, cv::COLOR_YUV2BGR_NV21}},
      // All rows of luma, followed by as many rows of chroma of twice the length (V4L2's NV24).
      {"nv24", {CV_8UC1, kPlanar444, kPlanar444}},
  };
  return encodings;
}

bool IsHalfPlanar(const std::string& encoding) { return encoding == "nv12" || encoding == "nv21"; }

// Rows in memory, each of the length of a row of luma.
int StoredRows(const RosPicture& picture, int type) {
  const int rows = static_cast<int>(picture.height);
  if (IsHalfPlanar(picture.encoding)) {
    if (rows % 2 != 0 || picture.width % 2 != 0) ThrowInput("is damaged: its size is odd");
    return rows + rows / 2;
  }
  if (CV_MAT_CN(type) == 2 && picture.width % 2 != 0) ThrowInput("is damaged: its width is odd");
  return picture.encoding == "nv24" ? 3 * rows : rows;
}

// The message's pixels as an OpenCV image that refers to its bytes, padding included.
cv::Mat RawPixels(const RosPicture& picture, int type) {
  if (!IsPictureSize(picture.width, picture.height))
    ThrowInput("cannot be used: " + TooLargeText(picture.width, picture.height));
  const int rows = StoredRows(picture, type);
  const int columns = static_cast<int>(picture.width);
  const size_t row_bytes = static_cast<size_t>(columns) * CV_ELEM_SIZE(type);
  const size_t step = picture.step == 0 ? row_bytes : picture.step;
  if (step % static_cast<size_t>(CV_ELEM_SIZE1(type)) != 0)
    ThrowInput("is damaged: its rows have an odd length");
  // The padding of the last row may be missing.
  if (step < row_bytes || picture.data.size() < row_bytes ||
      (picture.data.size() - row_bytes) / step + 1 < static_cast<size_t>(rows))
    ThrowInput("is truncated: it has fewer bytes than its width and height require");
  return cv::Mat(rows, columns, type, const_cast<char*>(picture.data.data()), step);
}

// A copy in the machine's byte order.
cv::Mat InNativeOrder(const cv::Mat& raw, bool big_endian) {
  cv::Mat image = raw.clone();
  if (big_endian == (std::endian::native == std::endian::big)) return image;
  const size_t size = image.elemSize1();
  const size_t row_bytes = static_cast<size_t>(image.cols) * image.elemSize();
  for (int y = 0; y < image.rows; ++y) {
    uchar* row = image.ptr(y);
    for (size_t at = 0; at < row_bytes; at += size) std::reverse(row + at, row + at + size);
  }
  return image;
}

// BT.601 with luma of 16 to 235, as cvtColor() converts the other YUV encodings.
cv::Mat ColorOfPlanar444(const cv::Mat& raw) {
  const int rows = raw.rows / 3;
  cv::Mat color(rows, raw.cols, CV_8UC3);
  for (int y = 0; y < rows; ++y) {
    const uchar* luma = raw.ptr(y);
    auto* to = color.ptr<cv::Vec3b>(y);
    for (int x = 0; x < raw.cols; ++x) {
      // A row of chroma takes two of the rows in memory, the padding of both at its end.
      const uchar* chroma = raw.ptr(rows + 2 * y) + 2 * static_cast<ptrdiff_t>(x);
      const double c = 1.164383 * (luma[x] - 16), u = chroma[0] - 128, v = chroma[1] - 128;
      to[x] = {cv::saturate_cast<uchar>(c + 2.017232 * u),
               cv::saturate_cast<uchar>(c - 0.391762 * u - 0.812968 * v),
               cv::saturate_cast<uchar>(c + 1.596027 * v)};
    }
  }
  return color;
}

cv::Mat Converted(const cv::Mat& raw, int code) try {
  if (code == kAsIs) return raw.u ? raw : raw.clone();  // without u, the message owns the bytes
  cv::Mat image;
  cv::cvtColor(raw, image, code);
  return image;
} catch (const cv::Exception&) {  // for example an image too small for a Bayer pattern
  ThrowInput("cannot be converted to gray");
}

const RawEncoding& EncodingOf(const std::string& name) {
  const auto found = RawEncodings().find(name);
  if (found != RawEncodings().end()) return found->second;
  std::string known;
  for (const auto& [other, encoding] : RawEncodings()) {
    known += (known.empty() ? "" : ", ") + other;
  }
  ThrowInput("has the encoding `" + name.substr(0, 40) + "`, which is not read; read are " + known);
}

}  // namespace

void CheckRawEncoding(const std::string& encoding) { EncodingOf(encoding); }

DecodedImage DecodeRawPicture(const RosPicture& picture, ImageUse use) {
  const RawEncoding& encoding = EncodingOf(picture.encoding);
  cv::Mat raw = RawPixels(picture, encoding.type);
  if (CV_ELEM_SIZE1(encoding.type) > 1) raw = InNativeOrder(raw, picture.big_endian);
  DecodedImage decoded;
  if (use == ImageUse::kDepth) {
    if (encoding.to_color != kNone || (encoding.type != CV_16UC1 && encoding.type != CV_32FC1))
      ThrowInput("is not a depth image: its encoding is `" + picture.encoding +
                 "`; depth is 16UC1, mono16 or 32FC1");
    decoded.image = raw;
    return decoded;
  }
  if (encoding.to_gray == kNone) ThrowInput("is a depth image, not a camera image");
  const bool planar444 = encoding.to_gray == kPlanar444;
  decoded.image =
      planar444 ? raw.rowRange(0, raw.rows / 3).clone() : Converted(raw, encoding.to_gray);
  if (use == ImageUse::kGrayAndColor && encoding.to_color != kNone)
    decoded.color = planar444 ? ColorOfPlanar444(raw) : Converted(raw, encoding.to_color);
  return decoded;
}

}  // namespace alidade
