// Camera model as stored in calibration files, lens included. rectify.h converts it to the `Camera`
// used by the rest of the library.
#pragma once

#include <Eigen/Core>
#include <array>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

enum class Lens {
  kPinhole,  // radial-tangential distortion k1 k2 p1 p2 k3 (Brown 1966)
  // Equidistant with k1 k2 k3 k4: θd = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) (Kannala & Brandt
  // 2006).
  kFisheye,
};

struct RawCamera {
  Lens lens = Lens::kPinhole;
  int width = 0, height = 0;           // pixels
  double fx = 0, fy = 0;               // pixels
  double cx = 0, cy = 0;               // pixels; the center of the top-left pixel is (0, 0)
  std::array<double, 5> distortion{};  // coefficients of the lens model; unused ones are 0

  // Raw pixel of a point in the camera frame. Requires z > 0 for a pinhole; a fisheye accepts any
  // direction except straight backwards.
  Eigen::Vector2d Project(const Eigen::Vector3d& p) const;
  // Unit direction in the camera frame of a raw pixel. Newton's method.
  Eigen::Vector3d Direction(const Eigen::Vector2d& pixel) const;
};

}  // namespace alidade
