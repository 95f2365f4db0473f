// Two small low-pass filters for 8 bit images, row by row. Outside the image its rim is repeated.
#pragma once

#include <opencv2/core.hpp>

namespace alidade {

// Weights 1 2 1 along both axes (standard deviation 0.71 pixels): takes most of the pixel noise,
// leaves corners. Row y of the level goes to row y - first_row of `out`, for y in [first_row,
// first_row + out.rows).
void SmoothBinomial(const cv::Mat& level, int first_row, cv::Mat out);

// 5x5 box (standard deviation 1.41 pixels), values times 250 / 256: only their order matters to
// descriptors. Row `first_row` + i of `image` goes to row i of `out`.
void SmoothBox(const cv::Mat& image, int first_row, cv::Mat out);

}  // namespace alidade
