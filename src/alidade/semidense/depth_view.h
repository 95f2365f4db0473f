// Depth of another keyframe, as one keyframe meets it.
#pragma once

#include <span>

#include "alidade/geometry/se3.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

struct DepthView {
  std::span<const EdgePixel> edges;
  std::span<const Hypothesis> depth;  // one for each edge
  Se3 T_view_reference;
  float scale = 1;  // its inverse depths are multiplied by this before they are compared
};

}  // namespace alidade
