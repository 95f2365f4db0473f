// Semi-dense depth of a keyframe.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct DepthPixel {
  uint16_t x = 0, y = 0;  // undistorted pixel of the keyframe's camera
  // Inverse depth along z, 1/m (mono: 1/map unit), and its standard deviation.
  float inverse_depth = 0, sigma = 0;
  std::array<uint8_t, 3> rgb{};  // red, green, blue
};

// Stored relative to the keyframe, so it moves with the keyframe's pose. Current lengths are those
// stored × KeyFrame::scale / `scale`.
struct DepthMap {
  int width = 0, height = 0;       // size of the camera's image, pixels
  double scale = 1;                // KeyFrame::scale at the time of estimation
  std::vector<DepthPixel> pixels;  // by row, then column
};

}  // namespace alidade
