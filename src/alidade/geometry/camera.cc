#include "alidade/geometry/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"

namespace alidade {
namespace {

// Larger than any real camera's parameters; squares and powers of such numbers stay finite.
constexpr double kMost = 1e9;
constexpr double kLongestReadout = 0.2;  // seconds; rolling shutters take 0.005 to 0.04 s

}  // namespace

void Camera::Check() const {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) ThrowInput("camera: " + what);
  };
  require(width > 0 && height > 0, "width and height must be positive");
  require(IsPictureSize(width, height), TooLargeText(width, height));
  require(std::isfinite(fx) && std::isfinite(fy) && fx > 0 && fy > 0,
          "fx and fy must be positive numbers");
  require(std::isfinite(cx) && std::isfinite(cy), "cx and cy must be numbers");
  for (double k : distortion) require(std::isfinite(k), "distortion must be numbers");
  for (double seconds : readout) {
    require(std::abs(seconds) <= kLongestReadout,
            "readout is the time from the first to the last row, at most 0.2 seconds");
  }
  require(std::isfinite(fps) && fps > 0, "fps must be a positive number");
  require(std::isfinite(depth_factor) && depth_factor >= 0,
          "depth_factor must be zero or positive");
  require(std::isfinite(baseline) && baseline >= 0, "baseline must be zero or positive");
  const auto within = [](double v) { return std::abs(v) <= kMost; };
  bool all = true;
  for (double v : {fx, fy, 1 / fx, 1 / fy, cx, cy, fps, 1 / fps, depth_factor, baseline})
    all = all && within(v);
  for (double v : distortion) all = all && within(v);
  require(all && (depth_factor == 0 || within(1 / depth_factor)),
          "it has a number that cannot be, beyond 1e9 or, where it divides, below 1e-9");
}

bool Camera::HasDistortion() const {
  for (double k : distortion) {
    if (k != 0) return true;
  }
  return false;
}

Eigen::Vector2d Camera::Distort(const Eigen::Vector2d& pixel) const {
  const double x = (pixel.x() - cx) / fx, y = (pixel.y() - cy) / fy;
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + cx,
          fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + cy};
}

Eigen::Vector2d Camera::Undistort(const Eigen::Vector2d& distorted) const {
  if (!HasDistortion()) return distorted;
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double xd = (distorted.x() - cx) / fx, yd = (distorted.y() - cy) / fy;
  double x = xd, y = yd;
  for (int i = 0; i < 20; ++i) {
    const double r2 = x * x + y * y;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double slope = k1 + r2 * (2 * k2 + r2 * 3 * k3);  // d radial / d r2
    const double ex = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) - xd;
    const double ey = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y - yd;
    const double a = radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x;
    const double b = 2 * x * y * slope + 2 * p1 * x + 2 * p2 * y;  // symmetric
    const double d = radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x;
    const double det = a * d - b * b;
    if (std::abs(det) < 1e-9) break;
    const double dx = (d * ex - b * ey) / det, dy = (a * ey - b * ex) / det;
    x -= dx;
    y -= dy;
    if (dx * dx + dy * dy < 1e-20) break;
  }
  const Eigen::Vector2d ideal(fx * x + cx, fy * y + cy);
  // Far outside the image the distortion polynomial may have no solution, and the iteration
  // diverges.
  const bool found = ideal.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kMost;
  return found ? ideal : distorted;
}

Camera Camera::ScaledToWidth(int new_width) const {
  if (new_width <= 0) ThrowUsage("image width must be positive");
  const double scale = static_cast<double>(new_width) / width;
  Camera scaled = *this;
  scaled.width = new_width;
  scaled.height = std::max(1, static_cast<int>(std::lround(height * scale)));
  const double scale_y = static_cast<double>(scaled.height) / height;
  scaled.fx = fx * scale;
  scaled.fy = fy * scale_y;
  // Pixel centers are at integers, image borders at ±0.5.
  scaled.cx = (cx + 0.5) * scale - 0.5;
  scaled.cy = (cy + 0.5) * scale_y - 0.5;
  return scaled;
}

Camera Camera::FromFieldOfView(int width, int height, double horizontal_fov_degrees) {
  if (!(horizontal_fov_degrees > 0 && horizontal_fov_degrees < 180)) {
    ThrowUsage("field of view must lie between 0 and 180 degrees");
  }
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = width / (2 * std::tan(horizontal_fov_degrees * std::numbers::pi / 360));
  camera.fy = camera.fx;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

}  // namespace alidade
