// How large a picture may be.
#pragma once

#include <cstdint>
#include <string>

namespace alidade {

// A run keeps some 18 bytes for each pixel (pyramid, smoothed levels, maps that undistort): 1.2 GB.
// Few cameras have more than 50 million pixels.
inline constexpr int64_t kMostPixels = int64_t{1} << 26;  // 8192 x 8192
// Pixels. OpenCV's remap() counts in 16 bits with sign, and a border is needed.
inline constexpr int kMostSide = 20000;

// Whether width and height are positive and within those limits.
inline bool IsPictureSize(int64_t width, int64_t height) {
  return width > 0 && height > 0 && width <= kMostSide && height <= kMostSide &&
         width * height <= kMostPixels;
}

// What to tell when they are beyond, and what to do about it.
inline std::string TooLargeText(int64_t width, int64_t height) {
  return "pictures of " + std::to_string(width) + "x" + std::to_string(height) +
         " are too large: at most " + std::to_string(kMostPixels / 1000000) +
         " million pixels and " + std::to_string(kMostSide) +
         " a side can be worked on; scale them down";
}

}  // namespace alidade
