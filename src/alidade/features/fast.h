// FAST-9 corners: at least 9 contiguous pixels of the 16 on a circle are all brighter or all darker
// than the center by more than a threshold (Rosten & Drummond 2006). The score is the largest such
// threshold.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct Corner {
  int x = 0, y = 0;  // pixels of the level
  int score = 0;     // largest threshold at which it still is a corner, gray levels
};

// Corners of score >= `threshold` after 3x3 non-maximum suppression (of equal ones the first in
// reading order is kept), in rows [first_row, end_row), at least `border` >= 18 pixels from the
// left and right sides. `image` must have 4 more rows above and below. Sorted by row, then column.
// The results of adjacent bands of rows concatenate to that of the whole image.
std::vector<Corner> FastCorners(const cv::Mat& image, int threshold, int border, int first_row,
                                int end_row);

// Sub-pixel position: maximum of the quadratic fitted to the scores of the 3x3 pixels around the
// corner, limited to 0.6 pixels along each axis.
Eigen::Vector2d RefineCorner(const cv::Mat& image, const Corner& corner);

}  // namespace alidade
