// An eye that fingers or a mouse lead around a place.
#pragma once

#include "alidade/gles/extent.h"
#include "alidade/gles/view.h"

namespace alidade::gles {

// Looks at `centre` from `distance` away. `yaw` turns around the upright axis, `pitch` is how far
// above the level the eye stands; radians.
struct Orbit {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double distance = 3;  // world units
  double yaw = 0.5, pitch = 0.6;
  // Rows: right, forward and up in the world, orthonormal. World's y points down as the first
  // keyframe's camera was held.
  Eigen::Matrix3d axes = (Eigen::Matrix3d() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished();

  // All of the scene's active map in sight. Up is where the keyframes' pictures have it on average,
  // when they are turned clockwise by `rotation` degrees to be upright.
  void Fit(const StreamScene& scene, int rotation = 0);

  // Pixels a finger moved to the right and down, on a view `height` pixels high: the place turns
  // with it, or goes with it.
  void Turn(double right, double down, double height);
  void Pan(double right, double down, double height, double fov);
  void Zoom(double factor);  // above 1: nearer

  Se3 T_world_eye() const;
  // Sets the view's eye, and what is cut off near it.
  void Apply(ViewSettings& view) const;
};

}  // namespace alidade::gles
