// Limits on image size.
#pragma once

#include <cstdint>
#include <string>

namespace alidade {

// A run keeps about 18 bytes per pixel (pyramid, smoothed levels, undistortion maps), 1.2 GB at
// this limit. Few cameras exceed 50 million pixels.
inline constexpr int64_t kMostPixels = int64_t{1} << 26;  // 8192 x 8192
// Largest width or height, pixels: cv::remap() uses signed 16-bit coordinates and needs a border.
inline constexpr int kMostSide = 20000;

// True if width and height are positive and within both limits.
inline bool IsPictureSize(int64_t width, int64_t height) {
  return width > 0 && height > 0 && width <= kMostSide && height <= kMostSide &&
         width * height <= kMostPixels;
}

// Error text for an image beyond the limits.
inline std::string TooLargeText(int64_t width, int64_t height) {
  return "images of " + std::to_string(width) + "x" + std::to_string(height) +
         " are too large: at most " + std::to_string(kMostPixels / 1000000) +
         " million pixels and " + std::to_string(kMostSide) +
         " per side are supported; scale them down";
}

}  // namespace alidade
