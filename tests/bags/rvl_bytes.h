// Writer of RVL (A. D. Wilson, "Fast Lossless Depth Image Compression", ISS 2017), implemented from
// the paper, independently of the reader.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace alidade {

// `depth`: CV_16UC1. Width and height stand before the packed pixels, as in ROS.
inline std::string RvlBytes(const cv::Mat& depth) {
  std::vector<unsigned> nibbles;
  const auto number = [&](unsigned value) {
    do {
      nibbles.push_back((value & 7) | (value > 7 ? 8 : 0));
      value >>= 3;
    } while (value != 0);
  };
  const std::vector<uint16_t> pixels(depth.begin<uint16_t>(), depth.end<uint16_t>());
  int previous = 0;
  for (size_t at = 0; at < pixels.size();) {
    size_t end = at;
    while (end < pixels.size() && pixels[end] == 0) ++end;
    number(static_cast<unsigned>(end - at));
    at = end;
    while (end < pixels.size() && pixels[end] != 0) ++end;
    number(static_cast<unsigned>(end - at));
    for (; at < end; ++at) {
      const int step = pixels[at] - previous;
      number(static_cast<unsigned>(step < 0 ? -2 * step - 1 : 2 * step));
      previous = pixels[at];
    }
  }
  while (nibbles.size() % 8 != 0) nibbles.push_back(0);
  std::string bytes;
  const auto word = [&](uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 255);
  };
  word(static_cast<uint32_t>(depth.cols));
  word(static_cast<uint32_t>(depth.rows));
  for (size_t i = 0; i < nibbles.size(); i += 8) {
    uint32_t packed = 0;
    for (size_t k = 0; k < 8; ++k) packed = packed << 4 | nibbles[i + k];
    word(packed);
  }
  return bytes;
}

}  // namespace alidade
