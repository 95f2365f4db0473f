// Smoothing within a keyframe (Mur-Artal & Tardós, RSS 2015, §III-C).
#pragma once

#include <span>
#include <vector>

#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

// Keeps hypotheses with at least two compatible neighbors in the 3x3 window, averaged with them.
// Fills unknown pixels from at least two neighbors that agree. `depth`: one per entry of `edges`;
// returns one per edge.
std::vector<Hypothesis> Smooth(std::span<const EdgePixel> edges, std::span<const Hypothesis> depth,
                               cv::Size size, float chi2);

}  // namespace alidade
