// Depth images packed with RVL: A. D. Wilson, "Fast Lossless Depth Image Compression", ISS 2017.
#pragma once

#include <opencv2/core.hpp>
#include <string_view>

namespace alidade {

// `bytes`: width and height (int32, little endian), then the packed pixels, as image_transport's
// compressedDepth stores them. RvlSize() is 0 x 0 when the bytes are too few.
cv::Size RvlSize(std::string_view bytes);
// CV_16UC1. Throws Error (input) when the bytes are damaged.
cv::Mat DecodeRvl(std::string_view bytes);

}  // namespace alidade
