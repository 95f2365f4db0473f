// Depth of another keyframe, for use in a reference keyframe.
#pragma once

#include <span>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

struct DepthView {
  std::span<const EdgePixel> edges;
  std::vector<Hypothesis> depth;  // one per edge, in current map units
  Se3 T_view_reference;
};

}  // namespace alidade
