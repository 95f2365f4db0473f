#include "alidade/synth/quadric_ray.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace alidade {

QuadricView SeenFrom(const Quadric& quadric, const Eigen::Matrix3d& R_world_camera,
                     const Eigen::Vector3d& camera) {
  return {quadric.from_world * (camera - quadric.origin), quadric.from_world * R_world_camera};
}

double MeetQuadric(const Quadric& quadric, const QuadricView& view, double x, double y) {
  const Eigen::Vector3d d = view.turn * Eigen::Vector3d(x, y, 1);
  const Eigen::Vector3d& q = view.start;
  if (quadric.kind == Quadric::Kind::kBall) {
    const double a = d.squaredNorm(), b = q.dot(d), c = q.squaredNorm() - 1;
    const double discriminant = b * b - a * c;
    if (discriminant <= 0) return 0;
    return std::max(0.0, (-b - std::sqrt(discriminant)) / a);
  }
  // x² + y² = (1 + k z)², limited to 0 <= z <= 1; the inside is visible through an open end.
  const double k = quadric.top - 1, radius = 1 + k * q.z();
  const double a = d.x() * d.x() + d.y() * d.y() - k * k * d.z() * d.z();
  const double b = q.x() * d.x() + q.y() * d.y() - k * d.z() * radius;
  const double c = q.x() * q.x() + q.y() * q.y() - radius * radius;
  const double discriminant = b * b - a * c;
  if (discriminant <= 0 || a == 0) return 0;
  const double root = std::sqrt(discriminant);
  double near = (-b - root) / a, far = (-b + root) / a;
  if (near > far) std::swap(near, far);
  for (const double z : {near, far}) {
    const double height = q.z() + z * d.z();
    if (z > 0 && height >= 0 && height <= 1) return z;
  }
  return 0;
}

QuadricHit ShadeQuadric(const Quadric& quadric, const QuadricView& view, double x, double y) {
  QuadricHit hit;
  hit.z = MeetQuadric(quadric, view, x, y);
  if (hit.z <= 0) return hit;
  const Eigen::Vector3d d = view.turn * Eigen::Vector3d(x, y, 1);
  const Eigen::Vector3d q = view.start + hit.z * d;
  hit.u = static_cast<float>(std::atan2(q.y(), q.x()) / (2 * std::numbers::pi) + 0.5);
  Eigen::Vector3d normal = q;
  if (quadric.kind == Quadric::Kind::kBall) {
    hit.v = static_cast<float>(std::acos(std::clamp(q.z(), -1.0, 1.0)) / std::numbers::pi);
  } else {
    hit.v = static_cast<float>(1 - q.z());
    const double k = quadric.top - 1;
    normal.z() = -k * (1 + k * q.z());
  }
  const bool inside = normal.dot(d) > 0;
  const Eigen::Vector3d n = (quadric.from_world.transpose() * normal).normalized();
  // Light from above and slightly from one side, fixed in the world and independent of the view.
  const double facing = 0.8 + 0.14 * n.z() + 0.06 * n.x();
  hit.light = static_cast<float>(quadric.light * (inside ? 0.5 : facing));
  return hit;
}

}  // namespace alidade
