// Depth of a keyframe made to agree with itself (Mur-Artal & Tardós, RSS 2015, §III-C).
#pragma once

#include <span>
#include <vector>

#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

// `depth`: one for each of `edges`. Kept: those with at least two compatible neighbours in their
// 3x3 window, smoothed over them. Grown: unknown ones between two that agree.
std::vector<Hypothesis> Smooth(std::span<const EdgePixel> edges, std::span<const Hypothesis> depth,
                               cv::Size size, float chi2);

}  // namespace alidade
