// Image files. JPEG and PNG are read and written by libjpeg and libpng directly. Other formats that
// OpenCV supports go through the media module, which is loaded on first use (see media.h).
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Detect the format by the file's first bytes. All throw Error (input) with the file's name and the
// reason: truncated, empty, not an image. A damaged image is an error; it is never decoded in part.
// ReadImageGray() returns CV_8UC1: the BT.601 luma, which for JPEG is the luma as stored; of 16
// bits the upper 8.
cv::Mat ReadImageGray(const std::string& path);
cv::Mat ReadImageColor(const std::string& path);  // CV_8UC3, blue green red
cv::Mat ReadDepth(const std::string& path);       // CV_16UC1 or CV_32FC1, values as stored

struct GrayAndColor {
  cv::Mat gray;   // equal to the result of ReadImageGray() bit for bit
  cv::Mat color;  // CV_8UC3, blue green red; empty when the file is gray
};
GrayAndColor ReadImageGrayAndColor(const std::string& path);  // decodes the file once
// The same with the bits of the file: `gray` of a gray image with 16 bits is CV_16UC1 (GrayLevels).
// `color` is empty unless asked for.
GrayAndColor ReadImageAsStored(const std::string& path, bool color);

// Width and height, from the header alone for JPEG and PNG.
cv::Size ReadImageSize(const std::string& path);

// Format by the ending: .png (8-bit gray or blue green red, 16-bit gray) or .jpg (8 bit, quality
// 95). The file is complete or absent, but not flushed to the disk (Sync::kNo).
void WriteImage(const std::string& path, const cv::Mat& image);

// True for an ending that the readers above may support.
bool HasImageEnding(std::string_view path);

}  // namespace alidade
