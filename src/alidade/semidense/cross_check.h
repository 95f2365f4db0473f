// Consistency check of a keyframe's depth against other keyframes (Mur-Artal & Tardós, RSS 2015,
// §III-D).
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

// Keeps a depth if at least `enough` views confirm it at one of the pixels around its projection,
// and refines it with those views (Gauss-Newton on inverse depth). Returns one hypothesis per edge;
// rejected ones are unknown.
std::vector<Hypothesis> CrossCheck(std::span<const EdgePixel> edges,
                                   std::span<const Hypothesis> depth,
                                   std::span<const DepthView> views, const Camera& camera,
                                   const CrossCheckSettings& settings);

}  // namespace alidade
