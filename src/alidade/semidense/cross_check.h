// Depth of a keyframe held against that of others (Mur-Artal & Tardós, RSS 2015, §III-D).
#pragma once

#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/semidense/depth_view.h"

namespace alidade {

struct CrossCheckSettings {
  float chi2 = 3.84f;
  int enough = 3;  // views that must confirm a depth
};

// Keeps what at least `enough` views confirm at one of the pixels around its projection, each
// adjusted to those that do (Gauss-Newton on inverse depths).
std::vector<Hypothesis> CrossCheck(std::span<const EdgePixel> edges,
                                   std::span<const Hypothesis> depth,
                                   std::span<const DepthView> views, const Camera& camera,
                                   const CrossCheckSettings& settings);

}  // namespace alidade
