// Inverse depth of a keyframe's edge pixels from one other keyframe: the best match along each
// epipolar line (Mur-Artal & Tardós, RSS 2015, §III-A).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "alidade/semidense/depth_range.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"
#include "alidade/semidense/settings.h"

namespace alidade {

// From a keyframe to another that is searched. Intensities there are gain * I + offset.
struct EpipolarPair {
  const GradientImage* reference = nullptr;
  const GradientImage* other = nullptr;
  Se3 T_other_reference;
  double gain = 1, offset = 0;  // unitless; grey levels
};

struct SearchCount {
  int64_t searches = 0;  // epipolar lines that were walked
  int64_t samples = 0;   // places on them
};

// For the edge pixels [begin, begin + found.size()): fills `found` in their order.
SearchCount SearchEpipolarLines(const EpipolarPair& pair, const Camera& camera,
                                const DepthRange& range, const SemiDenseSettings& settings,
                                size_t begin, std::span<Hypothesis> found);

}  // namespace alidade
