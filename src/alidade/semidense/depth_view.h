// Depth of another keyframe, as one keyframe meets it.
#pragma once

#include <span>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

struct DepthView {
  std::span<const EdgePixel> edges;
  std::vector<Hypothesis> depth;  // one for each edge, in the units of today
  Se3 T_view_reference;
};

}  // namespace alidade
