#include "alidade/geometry/raw_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/geometry/camera.h"

namespace alidade {
namespace {

double DistortedAngle(const std::array<double, 5>& k, double theta) {
  const double t2 = theta * theta;
  return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

double UndistortedAngle(const std::array<double, 5>& k, double distorted) {
  double theta = distorted;
  for (int i = 0; i < 20; ++i) {
    const double t2 = theta * theta;
    const double slope = 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
    if (!(std::abs(slope) > 1e-9)) break;
    const double step = (DistortedAngle(k, theta) - distorted) / slope;
    theta = std::clamp(theta - step, 0.0, std::numbers::pi);
    if (std::abs(step) < 1e-13) break;
  }
  return theta;
}

Camera AsPinhole(const RawCamera& raw) {
  Camera camera;
  camera.width = raw.width;
  camera.height = raw.height;
  camera.fx = raw.fx;
  camera.fy = raw.fy;
  camera.cx = raw.cx;
  camera.cy = raw.cy;
  camera.distortion = raw.distortion;
  return camera;
}

}  // namespace

Eigen::Vector2d RawCamera::Project(const Eigen::Vector3d& p) const {
  if (lens == Lens::kPinhole) {
    const Camera camera = AsPinhole(*this);
    return camera.Distort(camera.Project(p));
  }
  const double r = std::hypot(p.x(), p.y());
  const double distorted = DistortedAngle(distortion, std::atan2(r, p.z()));
  const double scale = r > 0 ? distorted / r : 0;
  return {fx * p.x() * scale + cx, fy * p.y() * scale + cy};
}

Eigen::Vector3d RawCamera::Direction(const Eigen::Vector2d& pixel) const {
  if (lens == Lens::kPinhole) {
    const Camera camera = AsPinhole(*this);
    return camera.Unproject(camera.Undistort(pixel)).normalized();
  }
  const double x = (pixel.x() - cx) / fx, y = (pixel.y() - cy) / fy;
  const double distorted = std::hypot(x, y);
  if (distorted == 0) return {0, 0, 1};
  const double theta = UndistortedAngle(distortion, distorted);
  const double scale = std::sin(theta) / distorted;
  return {x * scale, y * scale, std::cos(theta)};
}

}  // namespace alidade
