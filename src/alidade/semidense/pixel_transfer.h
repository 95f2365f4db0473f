// Position of a keyframe's pixel in another keyframe as a function of its inverse depth.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "alidade/geometry/camera.h"

namespace alidade {

// Homogeneous pixel there = at_infinity * (x, y, 1) + inverse depth * shift. Its third component is
// the depth there divided by the depth here.
struct PixelTransfer {
  Eigen::Matrix3f at_infinity;
  Eigen::Vector3f shift;

  PixelTransfer(const Camera& camera, const Se3& T_there_here) {
    Eigen::Matrix3d K;
    K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
    at_infinity = (K * T_there_here.R * K.inverse()).cast<float>();
    shift = (K * T_there_here.t).cast<float>();
  }
};

}  // namespace alidade
