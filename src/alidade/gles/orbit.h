// An orbit camera, controlled by touch or mouse.
#pragma once

#include "alidade/gles/extent.h"
#include "alidade/gles/view.h"

namespace alidade::gles {

// Looks at `centre` from `distance` away. `yaw`: rotation about the up axis; `pitch`: elevation
// above the horizontal; radians.
struct Orbit {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double distance = 3;  // world units
  double yaw = 0.5, pitch = 0.6;
  // Rows: right, forward and up in the world, orthonormal. The default assumes an upright first
  // camera: the world's y axis points down.
  Eigen::Matrix3d axes = (Eigen::Matrix3d() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished();

  // Fits the scene's active map into the view. Up is against gravity, or if that is unknown the
  // mean up direction of the keyframes' images after a clockwise rotation by `rotation` degrees.
  void Fit(const StreamScene& scene, int rotation = 0);

  // A drag by `right` and `down` pixels on a view `height` pixels high rotates or translates the
  // scene with it.
  void Turn(double right, double down, double height);
  void Pan(double right, double down, double height, double fov);
  void Zoom(double factor);  // above 1: closer

  Se3 T_world_eye() const;
  // Sets the view's eye and near plane.
  void Apply(ViewSettings& view) const;
};

}  // namespace alidade::gles
