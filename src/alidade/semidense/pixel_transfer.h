// Where a pixel of one keyframe is seen in another, by its inverse depth.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "alidade/geometry/camera.h"

namespace alidade {

// Homogeneous pixel there = at_infinity * (x, y, 1) + inverse depth * shift; its third component is
// the depth there over the depth here.
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
