// The reprojection residual of a camera (reprojection_formula.h), and which measurements have one.
#pragma once

#include <cmath>

#include "alidade/geometry/camera.h"
#include "alidade/optimize/reprojection_formula.h"

namespace alidade {

struct Intrinsics {
  double fx, fy, cx, cy;  // pixels
  double bf;              // pixels × map units: disparity = bf / z

  static Intrinsics Of(const Camera& camera) {
    return {camera.fx, camera.fy, camera.cx, camera.cy, camera.bf()};
  }
};

// True if a measured u_right is usable: it is finite (NaN means none) and the camera has a
// baseline.
inline bool HasRight(const Intrinsics& k, double seen_right) {
  return std::isfinite(seen_right) && k.bf > 0;
}

}  // namespace alidade
