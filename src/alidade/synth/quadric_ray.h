// Where a ray meets a quadric, and what is painted there.
#pragma once

#include <Eigen/Core>

#include "alidade/synth/scene.h"

namespace alidade {

// The quadric seen from one pose: rays are q = start + z * turn * (x, y, 1) in its own frame.
struct QuadricView {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
};

struct QuadricHit {
  double z = 0;        // metres along the camera's z; 0: missed
  float u = 0, v = 0;  // in its texture
  float light = 1;
};

QuadricView SeenFrom(const Quadric& quadric, const Eigen::Matrix3d& R_world_camera,
                     const Eigen::Vector3d& camera);
// Depth only; 0: missed.
double MeetQuadric(const Quadric& quadric, const QuadricView& view, double x, double y);
QuadricHit ShadeQuadric(const Quadric& quadric, const QuadricView& view, double x, double y);

}  // namespace alidade
