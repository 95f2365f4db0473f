// Depth of a keyframe held against that of others (Mur-Artal & Tardós, RSS 2015, §III-D).
#pragma once

#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

// Another keyframe's depth, and where it is.
struct DepthView {
  std::span<const EdgePixel> edges;
  std::span<const Hypothesis> depth;  // one for each edge
  Se3 T_view_reference;
  float scale = 1;  // its inverse depths are multiplied by this before they are compared
};

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
