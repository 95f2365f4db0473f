// Fits an image into a network's input with its aspect ratio kept, and maps boxes back to the
// image.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

namespace alidade {

// Position of the image in the network's input: x_input = inner / image · x_image + pad along each
// axis, measured from the outer edge of the first pixel.
struct Letterbox {
  cv::Size image, input;  // pixels
  cv::Size inner;         // size of the image in the input; the margins are gray
  int pad_left = 0, pad_top = 0;
};

// The largest centered fit. Throws Error (input) when a size is empty.
Letterbox FitInto(cv::Size image, cv::Size input);

// Returns CV_8UC3 of the input's size. `image`: CV_8UC3, or CV_8UC1, which is copied to three
// channels. Bilinear interpolation; margins of gray 114, as in the training of the YOLO networks.
cv::Mat Apply(const Letterbox& letterbox, const cv::Mat& image);

// Maps a box from the input, pixels, to the image and clips it. nullopt when less than 2 pixels of
// width or height remain, which is too small to be useful.
std::optional<cv::Rect2f> ToImage(const Letterbox& letterbox, const cv::Rect2f& box);

}  // namespace alidade
