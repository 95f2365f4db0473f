// Depth images smaller than the images they belong to.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace alidade {

std::string SizeText(cv::Size size);  // "640x480"

// Whether images of `size` have 2, 3, … times the width and height of `small`.
bool IsWholeFraction(cv::Size small, cv::Size size);

// What is done about depth images of size `depth` for images of `size`, as a message for users;
// empty when the sizes are equal. Throws Error (input) for sizes that do not fit.
std::string DepthSizeTold(cv::Size depth, cv::Size size);

// `depth` (2 or 4 bytes a pixel) at `size` when its size is a whole fraction 1 / n of that: every
// pixel becomes n x n equal ones, which cover the same part of the view. Else `depth` itself.
cv::Mat ScaledUpDepth(const cv::Mat& depth, cv::Size size);

}  // namespace alidade
