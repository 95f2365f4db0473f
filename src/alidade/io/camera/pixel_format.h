// The pixel formats of cameras, by the names of Linux's Video4Linux.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "alidade/io/files/image_codec.h"

namespace alidade {

struct PixelFormat {
  const char* name;
  uint32_t code;  // V4L2_PIX_FMT_…
  int bits;       // per pixel; 0: compressed
  bool color;
};

// In order of preference: those that cost least to read first. Null: not known.
const PixelFormat* FindPixelFormat(std::string_view name);
const PixelFormat* FindPixelFormat(uint32_t code);
int PreferenceOf(const PixelFormat& format);  // smaller is better
std::string NamesOfPixelFormats();            // "GREY, NV12, …", for users

// The image of `bytes` as the driver wrote them. `stride`: bytes from row to row; 0: no gaps.
// image: CV_8UC1, or CV_16UC1 (Y16). With `color`, also CV_8UC3 where the format has any.
DecodedImage DecodePixels(const PixelFormat& format, cv::Size size, size_t stride,
                          std::string_view bytes, bool color);

}  // namespace alidade
