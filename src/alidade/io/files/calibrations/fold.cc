#include "alidade/io/files/calibrations/fold.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace alidade {
namespace {

constexpr int kBorderSteps = 24;  // sampled pixels on each side of the image
constexpr int kPathSteps = 64;    // from the principal point to a pixel on the border

struct Bent {
  Eigen::Vector2d position;
  Eigen::Matrix2d J;  // d position / d ideal position
};

Bent Distort(const std::array<double, 5>& k, const Eigen::Vector2d& ideal) {
  const double x = ideal.x(), y = ideal.y(), r2 = ideal.squaredNorm();
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double slope = k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]);  // d radial / d r²
  Bent bent;
  bent.position = {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
                   y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
  const double mixed = 2 * x * y * slope + 2 * k[2] * x + 2 * k[3] * y;
  bent.J << radial + 2 * x * x * slope + 2 * k[2] * y + 6 * k[3] * x, mixed, mixed,
      radial + 2 * y * y * slope + 6 * k[2] * y + 2 * k[3] * x;
  return bent;
}

// Follows the straight path from the principal point to `end` (normalized, distorted) and its
// preimage, by Newton's method. Returns the share of the path that has one, 1 for all of it.
double ShareInverted(const std::array<double, 5>& k, const Eigen::Vector2d& end) {
  Eigen::Vector2d ideal = Eigen::Vector2d::Zero();
  for (int step = 1; step <= kPathSteps; ++step) {
    const Eigen::Vector2d wanted = end * step / kPathSteps;
    const double tolerance = 1e-6 * (1 + wanted.norm());
    const double reached = static_cast<double>(step - 1) / kPathSteps;
    Bent bent = Distort(k, ideal);
    for (int i = 0; i < 20 && (bent.position - wanted).norm() > tolerance; ++i) {
      if (!(bent.J.determinant() > 0)) return reached;
      ideal -= bent.J.inverse() * (bent.position - wanted);
      bent = Distort(k, ideal);
    }
    if (!((bent.position - wanted).norm() <= tolerance) || !(bent.J.determinant() > 0) ||
        !(bent.J.trace() > 0))
      return reached;
  }
  return 1;
}

std::optional<double> PinholeFold(const RawCamera& camera) {
  std::optional<double> radius;
  const auto look_at = [&](double u, double v) {
    const Eigen::Vector2d offset(u - camera.cx, v - camera.cy);
    const double share =
        ShareInverted(camera.distortion, {offset.x() / camera.fx, offset.y() / camera.fy});
    if (share < 1) radius = std::min(radius.value_or(1e300), share * offset.norm());
  };
  for (int i = 0; i <= kBorderSteps; ++i) {
    const double u = (camera.width - 1.0) * i / kBorderSteps;
    const double v = (camera.height - 1.0) * i / kBorderSteps;
    look_at(u, 0);
    look_at(u, camera.height - 1);
    look_at(0, v);
    look_at(camera.width - 1, v);
  }
  return radius;
}

std::optional<double> FisheyeFold(const RawCamera& camera) {
  const double u = std::max(camera.cx, camera.width - 1 - camera.cx) / camera.fx;
  const double v = std::max(camera.cy, camera.height - 1 - camera.cy) / camera.fy;
  const double corner = std::hypot(u, v);
  const auto& k = camera.distortion;
  constexpr int kAngles = 900;
  double reached = 0;
  for (int i = 1; i <= kAngles; ++i) {
    const double angle = std::numbers::pi / 2 * i / kAngles, a2 = angle * angle;
    const double slope = 1 + a2 * (3 * k[0] + a2 * (5 * k[1] + a2 * (7 * k[2] + a2 * 9 * k[3])));
    const double bent = angle * (1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
    if (!(slope > 0)) return reached * std::min(camera.fx, camera.fy);
    if (bent >= corner) return std::nullopt;
    reached = bent;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> FoldRadius(const RawCamera& camera) {
  if (camera.distortion == std::array<double, 5>{}) return std::nullopt;
  return camera.lens == Lens::kFisheye ? FisheyeFold(camera) : PinholeFold(camera);
}

}  // namespace alidade
