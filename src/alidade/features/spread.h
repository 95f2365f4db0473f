// Selection of well-distributed corners on a pyramid level.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/features/fast.h"

namespace alidade {

// For each cell (squares of `cell` pixels starting at (border, border)), keeps the corners with
// score >= `strong`, or all corners if there are none. Weakly textured regions keep corners, while
// noise next to strong corners is dropped.
std::vector<Corner> StrongPerCell(const std::vector<Corner>& corners, cv::Size level, int border,
                                  int cell, int strong);

// Selects at most `count` corners. A share `evenness` of them is distributed evenly: the strongest
// at the largest mutual distance that still yields that number (adaptive non-maximal suppression:
// Brown et al. 2005; square covering: Bailo et al. 2018). The remaining ones are the strongest at a
// smaller distance. Sorted by row, then column.
std::vector<Corner> SpreadCorners(const std::vector<Corner>& corners, cv::Size level, int count,
                                  double evenness);

}  // namespace alidade
