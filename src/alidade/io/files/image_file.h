// Images in files. JPEG and PNG are read and written by libjpeg and libpng themselves; what else
// OpenCV knows goes through the media module, which is loaded when such a file is first met (see
// media.h).
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// What a file is, by its first bytes. All throw Error (input) naming the file and what is wrong
// with it: cut short, empty, no image. A damaged image is an error, never a half grey picture.
cv::Mat ReadImageGray(
    const std::string& path);  // CV_8UC1; colours by BT.601 weights (JPEG: its luma as stored)
cv::Mat ReadImageColor(const std::string& path);  // CV_8UC3, blue green red
cv::Mat ReadDepth(const std::string& path);       // CV_16UC1 (or CV_32FC1), values as stored

struct GrayAndColor {
  cv::Mat gray;   // as ReadImageGray() gives it, bit for bit
  cv::Mat color;  // CV_8UC3, blue green red; empty when the file is grey
};
GrayAndColor ReadImageGrayAndColor(const std::string& path);  // decodes once

// Width and height; for JPEG and PNG from the header alone.
cv::Size ReadImageSize(const std::string& path);

// By the ending: .png (8 bit grey or blue green red, 16 bit grey) or .jpg (8 bit, quality 95). The
// file is written whole or not at all, but not flushed to the disk (Sync::kNo).
void WriteImage(const std::string& path, const cv::Mat& image);

bool HasImageEnding(std::string_view path);  // one that the readers above may understand

}  // namespace alidade
