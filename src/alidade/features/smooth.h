// Two small low-pass filters for 8-bit images, computed row by row. The image border is replicated.
#pragma once

#include <opencv2/core.hpp>

namespace alidade {

// Binomial filter 1 2 1 along both axes (standard deviation 0.71 pixels): removes most pixel noise
// and preserves corners. Row y of the level is written to row y - first_row of `out`, for y in
// [first_row, first_row + out.rows).
void SmoothBinomial(const cv::Mat& level, int first_row, cv::Mat out);

// 5x5 box filter (standard deviation 1.41 pixels), scaled by 250 / 256, which does not affect the
// comparisons of the descriptor. Row `first_row` + i of `image` is written to row i of `out`.
void SmoothBox(const cv::Mat& image, int first_row, cv::Mat out);

}  // namespace alidade
