// A camera as mounted and calibrated, lens and all: what calibration files hold. rectify.h makes
// the `Camera` the rest of the program works with from it.
#pragma once

#include <Eigen/Core>
#include <array>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

enum class Lens {
  kPinhole,  // radial-tangential distortion k1 k2 p1 p2 k3 (Brown 1966)
  kFisheye,  // equidistant with k1 k2 k3 k4: θd = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) (Kannala &
             // Brandt 2006)
};

struct RawCamera {
  Lens lens = Lens::kPinhole;
  int width = 0, height = 0;           // pixels
  double fx = 0, fy = 0;               // pixels
  double cx = 0, cy = 0;               // pixels; the centre of the top-left pixel is 0, 0
  std::array<double, 5> distortion{};  // as the lens says; unused ones are 0

  // Where a point in front of the camera (z > 0; for a fisheye any direction but straight back) is
  // seen.
  Eigen::Vector2d Project(const Eigen::Vector3d& p) const;
  // Unit direction seen at a pixel, by Newton's method.
  Eigen::Vector3d Direction(const Eigen::Vector2d& pixel) const;
};

}  // namespace alidade
