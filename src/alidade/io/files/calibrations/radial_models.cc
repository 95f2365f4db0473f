#include "alidade/io/files/calibrations/radial_models.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/lens_fit.h"

namespace alidade {
namespace {

// Unified model: the point on the unit sphere is projected from a center at distance xi behind it.
// Valid while z > -w |p|, beyond which two directions share a pixel.
std::optional<Eigen::Vector2d> ProjectUnified(double alpha, double beta, const Eigen::Vector3d& p) {
  const double d = std::sqrt(beta * p.head<2>().squaredNorm() + p.z() * p.z());
  const double w = alpha > 0.5 ? (1 - alpha) / alpha : alpha / (1 - alpha);
  const double below = alpha * d + (1 - alpha) * p.z();
  if (!(p.z() > -w * d) || !(below > 1e-9)) return std::nullopt;
  return Eigen::Vector2d(p.head<2>() / below);
}

std::optional<Eigen::Vector2d> ProjectDoubleSphere(double xi, double alpha,
                                                   const Eigen::Vector3d& p) {
  const double w1 = alpha > 0.5 ? (1 - alpha) / alpha : alpha / (1 - alpha);
  const double w2 = (w1 + xi) / std::sqrt(2 * w1 * xi + xi * xi + 1);
  const double d1 = p.norm(), z = xi * d1 + p.z();
  const double d2 = std::sqrt(p.head<2>().squaredNorm() + z * z);
  const double below = alpha * d2 + (1 - alpha) * z;
  if (!(p.z() > -w2 * d1) || !(below > 1e-9)) return std::nullopt;
  return Eigen::Vector2d(p.head<2>() / below);
}

std::optional<Eigen::Vector2d> ProjectFov(double w, const Eigen::Vector3d& p) {
  const double r = p.head<2>().norm();
  if (r == 0) return Eigen::Vector2d(0, 0);
  const double bent = std::atan2(2 * r * std::tan(w / 2), p.z()) / w;
  return Eigen::Vector2d(p.head<2>() / r * bent);
}

}  // namespace

void SetRadialModel(const YamlFile& file, const YAML::Node& model, const std::string& model_key,
                    const std::string& name, const YAML::Node& at, const std::string& key,
                    std::vector<double> v, const std::string& advice, RawCamera& camera,
                    std::string& told) {
  const bool one = name == "ucm" || name == "omni" || name == "fov";
  if (!one && name != "ds" && name != "eucm") {
    file.Fail(model, model_key + " `" + name.substr(0, 40) + "` is not supported: " + advice);
  }
  const size_t count = one ? 5 : 6;
  if (v.size() != count) {
    file.Fail(at, "`" + key + "` of the model " + name + " must have " + std::to_string(count) +
                      " numbers, not " + std::to_string(v.size()));
  }
  SetIntrinsics(file, at, key, {v[0], v[1], v[2], v[3]}, camera);
  const double a = v[4], b = v.back();
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) file.Fail(at, "`" + key + "` of the model " + name + ": " + what);
  };
  LensProjection project;
  if (name == "ds") {
    require(a > -1 && a < 10 && b >= 0 && b <= 1, "xi must be above -1 and alpha from 0 to 1");
    project = [=](const Eigen::Vector3d& p) { return ProjectDoubleSphere(a, b, p); };
  } else if (name == "eucm") {
    require(a >= 0 && a <= 1 && b > 0 && b < 1e3, "alpha must be from 0 to 1, beta positive");
    project = [=](const Eigen::Vector3d& p) { return ProjectUnified(a, b, p); };
  } else if (name == "ucm") {
    require(a >= 0 && a <= 1, "alpha must be from 0 to 1");
    project = [=](const Eigen::Vector3d& p) { return ProjectUnified(a, 1, p); };
  } else if (name == "omni") {
    // f (x, y) / (z + xi d) = f / (1 + xi) (x, y) / (alpha d + (1 - alpha) z), alpha = xi / (1 +
    // xi)
    require(a >= 0 && a < 1e3, "xi must not be negative");
    camera.fx /= 1 + a;
    camera.fy /= 1 + a;
    project = [alpha = a / (1 + a)](const Eigen::Vector3d& p) {
      return ProjectUnified(alpha, 1, p);
    };
  } else {
    require(a > 1e-6 && a < 3, "w must be positive and below 3 (radians)");
    project = [=](const Eigen::Vector3d& p) { return ProjectFov(a, p); };
  }
  try {
    Tell(told, ApproximateLens(name, SampleLens(camera, project), camera));
  } catch (const Error& error) {
    file.Fail(model, model_key + " " + error.what() + "; " + advice);
  }
}

}  // namespace alidade
