// Intersection of a ray with a quadric, and shading.
#pragma once

#include <Eigen/Core>

#include "alidade/synth/scene.h"

namespace alidade {

// The quadric as seen from one pose: rays in its own frame are q = start + z * turn * (x, y, 1).
struct QuadricView {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
};

struct QuadricHit {
  double z = 0;        // along the camera's z, meters; 0: no intersection
  float u = 0, v = 0;  // texture coordinates
  float light = 1;
};

QuadricView SeenFrom(const Quadric& quadric, const Eigen::Matrix3d& R_world_camera,
                     const Eigen::Vector3d& camera);
// Depth only; 0: no intersection.
double MeetQuadric(const Quadric& quadric, const QuadricView& view, double x, double y);
QuadricHit ShadeQuadric(const Quadric& quadric, const QuadricView& view, double x, double y);

}  // namespace alidade
