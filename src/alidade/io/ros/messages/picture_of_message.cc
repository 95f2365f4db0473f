#include "alidade/io/ros/messages/picture_of_message.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/files/image_file.h"

namespace alidade {
namespace {

// Conversion of an encoding of sensor_msgs/image_encodings to gray and to color.
struct RawEncoding {
  int type;      // OpenCV type of the message's pixels
  int to_gray;   // cvtColor code; kAsIs: already gray
  int to_color;  // cvtColor code to blue green red; kAsIs: already that; kNone: no color
};
constexpr int kAsIs = -1, kNone = -2;

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
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2GRAY, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2GRAY, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2GRAY, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2GRAY, cv::COLOR_BayerGB2BGR}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2GRAY_UYVY, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2GRAY_UYVY, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2GRAY_YUY2, cv::COLOR_YUV2BGR_YUY2}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2GRAY_YUY2, cv::COLOR_YUV2BGR_YUY2}},
      // All rows of luma, followed by half as many rows of chroma.
      {"nv12", {CV_8UC1, cv::COLOR_YUV2GRAY_NV12, cv::COLOR_YUV2BGR_NV12}},
      {"nv21", {CV_8UC1, cv::COLOR_YUV2GRAY_NV21, cv::COLOR_YUV2BGR_NV21}},
  };
  return encodings;
}

bool IsPlanar(const std::string& encoding) { return encoding == "nv12" || encoding == "nv21"; }

// The message's pixels as an OpenCV image that refers to its bytes, padding included.
cv::Mat RawPixels(const RosPicture& picture, int type) {
  if (!IsPictureSize(picture.width, picture.height))
    ThrowInput("cannot be used: " + TooLargeText(picture.width, picture.height));
  int rows = static_cast<int>(picture.height);
  const int columns = static_cast<int>(picture.width);
  if (IsPlanar(picture.encoding)) {
    if (rows % 2 != 0 || columns % 2 != 0) ThrowInput("is damaged: its size is odd");
    rows += rows / 2;
  } else if (CV_MAT_CN(type) == 2 && columns % 2 != 0) {
    ThrowInput("is damaged: its width is odd");
  }
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
  for (int y = 0; y < image.rows; ++y) {
    uchar* row = image.ptr(y);
    for (size_t x = 0; x < static_cast<size_t>(image.cols); ++x)
      std::reverse(row + x * size, row + (x + 1) * size);
  }
  return image;
}

cv::Mat Converted(const cv::Mat& raw, int code) try {
  if (code == kAsIs) return raw.clone();
  cv::Mat image;
  cv::cvtColor(raw, image, code);
  return image;
} catch (const cv::Exception&) {  // for example an image too small for a Bayer pattern
  ThrowInput("cannot be converted to gray");
}

DecodedImage RawPictureOf(const RosPicture& picture, ImageUse use) {
  const auto found = RawEncodings().find(picture.encoding);
  if (found == RawEncodings().end())
    ThrowInput("has the encoding `" + picture.encoding.substr(0, 40) + "`, which is not supported");
  const RawEncoding& encoding = found->second;
  const cv::Mat raw = RawPixels(picture, encoding.type);
  DecodedImage decoded;
  if (use == ImageUse::kDepth) {
    if (encoding.type != CV_16UC1 && encoding.type != CV_32FC1)
      ThrowInput("is not a depth image: its encoding is `" + picture.encoding + "`");
    decoded.image = InNativeOrder(raw, picture.big_endian);
    return decoded;
  }
  if (encoding.to_gray == kNone) ThrowInput("is a depth image, not a camera image");
  decoded.image = encoding.type == CV_16UC1 ? InNativeOrder(raw, picture.big_endian)
                                            : Converted(raw, encoding.to_gray);
  if (use == ImageUse::kGrayAndColor && encoding.to_color != kNone)
    decoded.color = Converted(raw, encoding.to_color);
  return decoded;
}

bool IsCompressedDepth(const RosPicture& picture) {
  return picture.compressed && picture.encoding.find("compressedDepth") != std::string::npos;
}

float FloatAt(std::string_view bytes, size_t at) {
  float value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// image_transport's compressedDepth: an integer, two floats a and b, and a 16-bit PNG. Depth in
// meters is stored as v = a / z + b; depth in millimeters is stored directly.
constexpr size_t kCompressedDepthHead = 12;

DecodedImage CompressedDepthOf(const RosPicture& picture) {
  if (picture.data.size() <= kCompressedDepthHead) ThrowInput("is truncated");
  const std::string_view packed = picture.data.substr(kCompressedDepthHead);
  if (!LooksLikePng(packed))
    ThrowInput("is depth with a compression other than PNG (`" + picture.encoding.substr(0, 40) +
               "`), which is not supported");
  DecodedImage decoded = DecodePng(packed, ImageUse::kDepth);
  if (!decoded.problem.empty() || picture.encoding.rfind("32FC1", 0) != 0) return decoded;
  const float a = FloatAt(picture.data, 4), b = FloatAt(picture.data, 8);
  cv::Mat metres(decoded.image.size(), CV_32FC1);
  for (int y = 0; y < metres.rows; ++y) {
    for (int x = 0; x < metres.cols; ++x) {
      const uint16_t v = decoded.image.at<uint16_t>(y, x);
      metres.at<float>(y, x) = v == 0 ? 0 : a / (static_cast<float>(v) - b);
    }
  }
  decoded.image = metres;
  return decoded;
}

}  // namespace

DecodedImage PictureOf(const RosPicture& picture, ImageUse use) {
  if (!picture.compressed) return RawPictureOf(picture, use);
  if (IsCompressedDepth(picture) && use != ImageUse::kDepth)
    ThrowInput("is a depth image, not a camera image");
  DecodedImage decoded =
      IsCompressedDepth(picture) ? CompressedDepthOf(picture) : DecodeImageBytes(picture.data, use);
  if (!decoded.problem.empty()) ThrowInput(decoded.problem);
  const int type = decoded.image.type();
  if (use == ImageUse::kDepth && type != CV_16UC1 && type != CV_32FC1)
    ThrowInput("is not a depth image: it has 8 bits");
  return decoded;
}

cv::Size SizeOfPicture(const RosPicture& picture) {
  if (!picture.compressed)
    return {static_cast<int>(std::min<uint32_t>(picture.width, kMostSide + 1)),
            static_cast<int>(std::min<uint32_t>(picture.height, kMostSide + 1))};
  std::string_view bytes = picture.data;
  if (IsCompressedDepth(picture)) bytes.remove_prefix(std::min(bytes.size(), kCompressedDepthHead));
  if (LooksLikeJpeg(bytes)) return JpegSize(bytes);
  if (LooksLikePng(bytes)) return PngSize(bytes);
  const DecodedImage decoded = DecodeImageBytes(bytes, ImageUse::kGray);
  return decoded.problem.empty() ? decoded.image.size() : cv::Size();
}

bool IsDepth(const RosPicture& picture) {
  if (IsCompressedDepth(picture)) return true;
  const std::string start = picture.encoding.substr(0, 5);
  return start == "16UC1" || start == "32FC1";
}

}  // namespace alidade
