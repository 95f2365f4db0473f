// FAST corners: a pixel on whose circle of 16 at least 9 in a row are all brighter, or all darker,
// than it by more than a threshold. Rosten & Drummond 2006; scored by the largest such threshold.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct Corner {
  int x = 0, y = 0;  // pixels of the level
  int score = 0;     // largest threshold at which it still is a corner, grey levels
};

// Corners of score >= `threshold` that no neighbour of the eight surpasses (of equal ones the first
// in reading order stays), in rows [first_row, end_row), `border` >= 18 pixels or more from the
// left and right side. Needs 4 rows above and below, in `image`. Sorted by row, then column. Bands
// of rows put together give what the whole image gives.
std::vector<Corner> FastCorners(const cv::Mat& image, int threshold, int border, int first_row,
                                int end_row);

// Where between the pixels the corner is: the top of the quadratic fitted to the scores of the 3x3
// pixels around. At most 0.6 pixels away, along each axis.
Eigen::Vector2d RefineCorner(const cv::Mat& image, const Corner& corner);

}  // namespace alidade
