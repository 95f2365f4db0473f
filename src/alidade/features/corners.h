// FAST corners of one pyramid level, and which of them to keep. Rosten & Drummond 2006.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace alidade {

struct Corner {
  int x = 0, y = 0;  // pixels of the level
  int score = 0;     // largest threshold at which it still is a corner, grey levels
};

// FAST-9/16 corners with 3x3 non-maximum suppression in the rows [first_row, end_row) of `level`,
// `border` pixels or more from each side, sorted by row, then column. Bands of rows put together
// give what the whole level gives.
std::vector<Corner> FastCorners(const cv::Mat& level, int threshold, int border, int first_row,
                                int end_row);

// In each cell (squares of `cell` pixels from the border on): the corners that reach `strong`, or
// where there are none, all. So weakly textured regions still have corners while noise beside
// strong corners is left out.
std::vector<Corner> StrongPerCell(const std::vector<Corner>& corners, cv::Size level, int border,
                                  int cell, int strong);

// At most `count` of the corners, spread evenly over the level: the strongest ones under the widest
// minimum distance that leaves enough (adaptive non-maximal suppression; Brown et al. 2005, by
// square covering as in Bailo et al. 2018). Sorted by row, then column.
std::vector<Corner> SpreadCorners(const std::vector<Corner>& corners, cv::Size level, int count);

}  // namespace alidade
