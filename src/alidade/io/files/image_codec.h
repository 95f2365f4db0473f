// Images to and from bytes. `problem` results are texts for people, without the file's name.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace alidade {

enum class ImageUse { kGray, kColor, kDepth, kGrayAndColor };

struct DecodedImage {
  cv::Mat image;        // CV_8UC1, CV_8UC3 or, for depth, what is stored
  std::string problem;  // not empty: why there is no image
  cv::Mat color = {};   // CV_8UC3; with kGrayAndColor only (`image` is the grey one then), and
                        // empty when what is stored is grey
};

// Whatever they are, by how they begin: JPEG, PNG, or what else the media module knows.
DecodedImage DecodeImageBytes(std::string_view bytes, ImageUse use);

bool LooksLikeJpeg(std::string_view bytes);
bool LooksLikePng(std::string_view bytes);
DecodedImage DecodeJpeg(std::string_view bytes, ImageUse use);
DecodedImage DecodePng(std::string_view bytes, ImageUse use);
cv::Size JpegSize(std::string_view bytes);  // 0 x 0 when the header cannot be read
cv::Size PngSize(std::string_view bytes);

std::string EncodeJpeg(const cv::Mat& image, int quality);
std::string EncodePng(const cv::Mat& image);

}  // namespace alidade
