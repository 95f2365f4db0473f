#include "alidade/io/ros/messages/compressed_depth.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>

#include "alidade/base/error.h"
#include "alidade/io/ros/messages/rvl.h"

namespace alidade {
namespace {

// An integer that names the quantization, then its parameters, two floats.
constexpr size_t kHeadBytes = 12;
constexpr std::string_view kName = "compressedDepth";

// The codec named in the format, "png" in "16UC1; compressedDepth png"; empty: none.
std::string CodecOf(const RosPicture& picture) {
  const size_t at = picture.encoding.find(kName);
  std::string word;
  for (const char c : picture.encoding.substr(at + kName.size())) {
    if (c != ' ' && c != ';') {
      word += c;
    } else if (!word.empty()) {
      break;
    }
  }
  return word;
}

// The packed image. A few recorders leave the head away.
std::string_view PackedOf(const RosPicture& picture) {
  if (LooksLikePng(picture.data)) return picture.data;
  return picture.data.substr(std::min(picture.data.size(), kHeadBytes));
}

bool IsRvl(const RosPicture& picture) {
  const std::string codec = CodecOf(picture);
  return codec == "rvl" || codec.empty();
}

float LittleFloatAt(std::string_view bytes, size_t at) {
  uint32_t bits = 0;
  for (size_t i = 4; i-- > 0;) bits = bits << 8 | static_cast<uint8_t>(bytes[at + i]);
  return std::bit_cast<float>(bits);
}

// Depth z in meters is stored as v = a / z + b; v = 0: no depth.
cv::Mat InMetres(const cv::Mat& stored, float a, float b) {
  cv::Mat metres(stored.size(), CV_32FC1);
  for (int y = 0; y < metres.rows; ++y) {
    const auto* from = stored.ptr<uint16_t>(y);
    auto* to = metres.ptr<float>(y);
    for (int x = 0; x < metres.cols; ++x) {
      const float inverse = static_cast<float>(from[x]) - b;
      to[x] = from[x] == 0 || !(inverse > 0) ? 0 : a / inverse;
    }
  }
  return metres;
}

}  // namespace

bool IsCompressedDepth(const RosPicture& picture) {
  return picture.compressed && picture.encoding.find(kName) != std::string::npos;
}

cv::Size SizeOfCompressedDepth(const RosPicture& picture) {
  const std::string_view packed = PackedOf(picture);
  if (LooksLikePng(packed)) return PngSize(packed);
  return IsRvl(picture) ? RvlSize(packed) : cv::Size();
}

DecodedImage DecodeCompressedDepth(const RosPicture& picture) {
  if (picture.data.size() <= kHeadBytes) ThrowInput("is truncated");
  const std::string_view packed = PackedOf(picture);
  DecodedImage decoded;
  if (LooksLikePng(packed)) {
    decoded = DecodePng(packed, ImageUse::kDepth);
  } else if (IsRvl(picture)) {
    decoded.image = DecodeRvl(packed);
  } else {
    ThrowInput("is depth with the compression `" + picture.encoding.substr(0, 40) +
               "`, which is not read, or damaged; read are png and rvl");
  }
  if (!decoded.problem.empty() || picture.encoding.rfind("32FC1", 0) != 0) return decoded;
  const bool has_head = packed.size() != picture.data.size();
  const float a = has_head ? LittleFloatAt(picture.data, 4) : 0;
  const float b = has_head ? LittleFloatAt(picture.data, 8) : 0;
  if (!std::isfinite(a) || !std::isfinite(b) || a <= 0) {
    ThrowInput("is depth whose quantization is missing or damaged: a = " + std::to_string(a) +
               ", b = " + std::to_string(b));
  }
  decoded.image = InMetres(decoded.image, a, b);
  return decoded;
}

}  // namespace alidade
