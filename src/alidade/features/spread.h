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

// At most `count` of the corners, spread evenly: the strongest under a minimum distance, which is
// the share `evenness` of the widest that leaves `count` of them (0: simply the strongest; 1: as
// even as can be). Adaptive non-maximal suppression (Brown et al. 2005) by square covering (Bailo
// et al. 2018). Sorted by row, then column.
std::vector<Corner> SpreadCorners(const std::vector<Corner>& corners, cv::Size level, int count,
                                  double evenness);

}  // namespace alidade
