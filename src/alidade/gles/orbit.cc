#include "alidade/gles/orbit.h"

#include <algorithm>
#include <cmath>

namespace alidade::gles {
namespace {

constexpr double kSteepest = 1.5;  // radians; near the pole yaw is undefined
constexpr double kHalfTurn = 3.14159265358979323846;

// Up direction in the frame of a camera whose image is upright after a clockwise rotation.
Eigen::Vector3d UpInCamera(int rotation) {
  switch (rotation) {
    case 90:
      return {-1, 0, 0};  // the left side becomes the top
    case 180:
      return {0, 1, 0};
    case 270:
      return {1, 0, 0};
    default:
      return {0, -1, 0};
  }
}

}  // namespace

void Orbit::Fit(const StreamScene& scene, int rotation) {
  const MapId active = scene.ActiveMap();
  const Eigen::Vector3d up_in_camera = UpInCamera(rotation);
  Eigen::Vector3d up = Eigen::Vector3d::Zero(), forward = Eigen::Vector3d::Zero();
  for (const auto& [id, keyframe] : scene.keyframes) {
    if (keyframe.map != active) continue;
    if (forward.isZero()) forward = keyframe.T_world_camera.R.col(2);
    up += keyframe.T_world_camera.R * up_in_camera;
  }
  if (up.norm() < 1e-6) up = up_in_camera;
  const MapWorld* world = FindWorld(scene.worlds, active);
  if (world && world->KnowsDown()) up = -world->down;
  up.normalize();
  forward -= forward.dot(up) * up;
  if (forward.norm() < 1e-3) {
    const bool along_z = std::abs(up.z()) < 0.9;
    forward = up.cross(up.cross(along_z ? Eigen::Vector3d(0, 0, -1) : Eigen::Vector3d(0, -1, 0)));
  }
  forward.normalize();
  axes.row(0) = forward.cross(up);
  axes.row(1) = forward;
  axes.row(2) = up;
  const Extent extent = ExtentOf(scene);
  centre = extent.centre;
  distance = 2.5 * extent.radius;  // fits a field of view of 0.9 radians
}

void Orbit::Turn(double right, double down, double height) {
  yaw = std::remainder(yaw - kHalfTurn * right / height, 2 * kHalfTurn);
  pitch = std::clamp(pitch + kHalfTurn * down / height, -kSteepest, kSteepest);
}

void Orbit::Pan(double right, double down, double height, double fov) {
  const double step = 2 * distance * std::tan(fov / 2) / height;  // world units per pixel
  const Se3 eye = T_world_eye();
  centre -= step * (right * eye.R.col(0) + down * eye.R.col(1));
}

void Orbit::Zoom(double factor) {
  if (factor > 0 && std::isfinite(factor)) distance = std::clamp(distance / factor, 1e-6, 1e9);
}

Se3 Orbit::T_world_eye() const {
  // Viewing direction z in the axes right, forward, up.
  const double cy = std::cos(yaw), sy = std::sin(yaw), cp = std::cos(pitch), sp = std::sin(pitch);
  const Eigen::Vector3d z(-sy * cp, cy * cp, -sp), x(cy, sy, 0);
  Eigen::Matrix3d R;
  R.col(0) = axes.transpose() * x;
  R.col(2) = axes.transpose() * z;
  R.col(1) = R.col(2).cross(R.col(0));
  return {R, centre - distance * R.col(2)};
}

void Orbit::Apply(ViewSettings& view) const {
  view.T_world_eye = T_world_eye();
  view.nearest = 0.005 * distance;
}

}  // namespace alidade::gles
