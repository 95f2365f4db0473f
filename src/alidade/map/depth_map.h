// Depth of a keyframe where it is known: at pixels with structure.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct DepthPixel {
  uint16_t x = 0, y = 0;  // undistorted pixel of the keyframe's camera
  float inverse_depth = 0,
        sigma = 0;               // along z, 1/m (mono: 1/map unit), and its standard deviation
  std::array<uint8_t, 3> rgb{};  // red green blue
};

// Depth stays in its keyframe and so moves with the pose. Lengths now are those here times
// KeyFrame::scale / `scale`.
struct DepthMap {
  int width = 0, height = 0;       // pixels, the camera's
  double scale = 1;                // KeyFrame::scale when it was estimated
  std::vector<DepthPixel> pixels;  // by row, then column
};

}  // namespace alidade
