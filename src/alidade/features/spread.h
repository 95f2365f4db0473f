// Which corners of a level to keep.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/features/fast.h"

namespace alidade {

// In each cell (squares of `cell` pixels from (border, border) on): the corners that reach
// `strong`, or where there are none, all. So weakly textured regions still have corners, while
// noise beside strong corners is left out.
std::vector<Corner> StrongPerCell(const std::vector<Corner>& corners, cv::Size level, int border,
                                  int cell, int strong);

// At most `count` of the corners. The share `evenness` of them is spread as evenly as can be: the
// strongest under the widest distance that leaves so many (adaptive non-maximal suppression: Brown
// et al. 2005, by square covering as in Bailo et al. 2018). So weak corners are kept where there is
// nothing else. The rest are the strongest ones, not crowded. Sorted by row, then column.
std::vector<Corner> SpreadCorners(const std::vector<Corner>& corners, cv::Size level, int count,
                                  double evenness);

}  // namespace alidade
