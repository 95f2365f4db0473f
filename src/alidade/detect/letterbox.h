// An image made to fit a network's input, its shape kept, and boxes brought back from there.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

namespace alidade {

// Where the image lies in the network's input: x_input = inner / image · x_image + pad along each
// axis, counted from the outer edge of the first pixel.
struct Letterbox {
  cv::Size image, input;  // pixels
  cv::Size inner;         // of the input, what the image fills; the rest is grey
  int pad_left = 0, pad_top = 0;
};

// The largest that fits, in the middle. Throws Error (input) when one of the two is empty.
Letterbox FitInto(cv::Size image, cv::Size input);

// CV_8UC3 of the input's size from `image` (CV_8UC3, or CV_8UC1 taken for three equal channels):
// resized bilinearly, margins of grey 114 as the YOLO networks were trained with.
cv::Mat Apply(const Letterbox& letterbox, const cv::Mat& image);

// A box of the input, pixels, in the image and clipped to it; none when less than two pixels of
// width or height are left, which no thing that is of use has.
std::optional<cv::Rect2f> ToImage(const Letterbox& letterbox, const cv::Rect2f& box);

}  // namespace alidade
