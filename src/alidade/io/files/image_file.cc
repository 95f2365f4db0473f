#include "alidade/io/files/image_file.h"

#include <algorithm>
#include <array>
#include <string>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/files/media.h"

namespace alidade {
namespace {

std::string LowerEnding(std::string_view path) {
  const size_t dot = path.rfind('.');
  if (dot == std::string_view::npos || path.find('/', dot) != std::string_view::npos) return {};
  std::string ending(path.substr(dot));
  for (char& c : ending) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return ending;
}

}  // namespace

DecodedImage DecodeImageBytes(std::string_view bytes, ImageUse use) {
  if (bytes.empty()) return {{}, "is empty"};
  if (LooksLikeJpeg(bytes)) return DecodeJpeg(bytes, use);
  if (LooksLikePng(bytes)) return DecodePng(bytes, use);
  if (use != ImageUse::kGrayAndColor) return DecodeByMediaModule(bytes, use);
  DecodedImage both = DecodeByMediaModule(bytes, ImageUse::kGray);
  if (both.problem.empty()) both.color = DecodeByMediaModule(bytes, ImageUse::kColor).image;
  return both;
}

namespace {

DecodedImage ReadDecoded(const std::string& path, ImageUse use) {
  const std::string bytes = ReadFile(path);
  DecodedImage decoded = DecodeImageBytes(bytes, use);
  if (!decoded.problem.empty()) ThrowInput(path + " " + decoded.problem);
  return decoded;
}

cv::Mat Read(const std::string& path, ImageUse use) { return ReadDecoded(path, use).image; }

// 65535 becomes 255, as in cv_bridge and libpng.
cv::Mat Of8Bits(const cv::Mat& gray) {
  if (gray.depth() != CV_16U) return gray;
  cv::Mat image;
  gray.convertTo(image, CV_8U, 1 / 257.0);
  return image;
}

}  // namespace

cv::Mat ReadImageGray(const std::string& path) { return Of8Bits(Read(path, ImageUse::kGray)); }
cv::Mat ReadImageColor(const std::string& path) { return Read(path, ImageUse::kColor); }
cv::Mat ReadDepth(const std::string& path) { return Read(path, ImageUse::kDepth); }

GrayAndColor ReadImageGrayAndColor(const std::string& path) {
  const DecodedImage decoded = ReadDecoded(path, ImageUse::kGrayAndColor);
  return {Of8Bits(decoded.image), decoded.color};
}

GrayAndColor ReadImageAsStored(const std::string& path, bool color) {
  const DecodedImage decoded = ReadDecoded(path, color ? ImageUse::kGrayAndColor : ImageUse::kGray);
  return {decoded.image, decoded.color};
}

cv::Size ReadImageSize(const std::string& path) {
  const std::string bytes = ReadFile(path);
  cv::Size size;
  if (LooksLikeJpeg(bytes)) {
    size = JpegSize(bytes);
  } else if (LooksLikePng(bytes)) {
    size = PngSize(bytes);
  } else {
    const DecodedImage decoded = DecodeImageBytes(bytes, ImageUse::kGray);
    if (!decoded.problem.empty()) ThrowInput(path + " " + decoded.problem);
    size = decoded.image.size();
  }
  if (size.empty()) ThrowInput(path + " has a damaged header");
  if (!IsPictureSize(size.width, size.height))
    ThrowInput(path + " cannot be used: " + TooLargeText(size.width, size.height));
  return size;
}

void WriteImage(const std::string& path, const cv::Mat& image) {
  const std::string ending = LowerEnding(path);
  if (ending == ".png") {
    AtomicWriteFile(path, EncodePng(image), Sync::kNo);
  } else if (ending == ".jpg" || ending == ".jpeg") {
    AtomicWriteFile(path, EncodeJpeg(image, 95), Sync::kNo);
  } else {
    ThrowUsage("cannot write " + path + ": images are written as .png or .jpg");
  }
}

bool HasImageEnding(std::string_view path) {
  static constexpr std::array<std::string_view, 10> kEndings = {
      ".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp", ".pgm", ".ppm", ".pnm"};
  const std::string ending = LowerEnding(path);
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

}  // namespace alidade
