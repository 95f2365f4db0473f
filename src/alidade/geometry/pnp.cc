#include "alidade/geometry/pnp.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/random.h"
#include "alidade/geometry/samples_needed.h"

namespace alidade {
namespace {

struct PointMatch {
  Eigen::Vector3d p_world;
  Eigen::Vector2d pixel;
  double inverse_squared;  // 1 / largest squared error, 1/px²
  size_t index;            // in the caller's arrays
};

// 1 for a perfect match, down to 0 at the largest error and beyond, and behind the camera.
double Gain(const Camera& camera, const Se3& T_camera_world, const PointMatch& match) {
  const Eigen::Vector3d p = T_camera_world * match.p_world;
  if (!(p.z() > 0)) return 0;
  const double squared = (camera.Project(p) - match.pixel).squaredNorm() * match.inverse_squared;
  return squared < 1 ? 1 - squared : 0;
}

}  // namespace

void PnpSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("pnp settings: ") + what);
  };
  require(max_iterations > 0, "max_iterations must be positive");
  require(max_error > 0 && std::isfinite(max_error), "max_error must be positive");
  require(confidence > 0 && confidence < 1, "confidence must lie between 0 and 1");
  require(min_inliers >= 3, "min_inliers must be at least 3");
}

PnpResult SolvePnpRansac(const Camera& camera, std::span<const Eigen::Vector3d> p_world,
                         std::span<const Eigen::Vector2d> pixels,
                         std::span<const double> sigma_scale, const PnpSettings& settings) {
  settings.Check();
  if (p_world.size() != pixels.size() ||
      (!sigma_scale.empty() && sigma_scale.size() != pixels.size())) {
    ThrowUsage("pnp: as many landmarks, pixels and scales are needed");
  }
  PnpResult result;
  result.inlier.assign(pixels.size(), false);
  std::vector<PointMatch> matches;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const double max_error = settings.max_error * (sigma_scale.empty() ? 1 : sigma_scale[i]);
    if (!p_world[i].allFinite() || !pixels[i].allFinite() || !(max_error > 0)) continue;
    matches.push_back({p_world[i], pixels[i], 1 / (max_error * max_error), i});
  }
  const int count = static_cast<int>(matches.size());
  if (count < settings.min_inliers) return result;

  // The score is MSAC's (Torr & Zisserman 2000): of two poses with the same inliers, the closer one
  // wins.
  Random random(settings.seed);
  double best_score = 0;
  double needed = settings.max_iterations;
  for (int iteration = 0; iteration < settings.max_iterations && iteration < needed; ++iteration) {
    const std::vector<int> sample = random.Sample(3, count);
    Eigen::Vector3d points[3], rays[3];
    for (int k = 0; k < 3; ++k) {
      points[k] = matches[sample[k]].p_world;
      rays[k] = camera.Unproject(matches[sample[k]].pixel).normalized();
    }
    for (const Se3& pose : SolveP3p(points, rays)) {
      double score = 0;
      int inliers = 0;
      for (const PointMatch& match : matches) {
        const double gain = Gain(camera, pose, match);
        score += gain;
        inliers += gain > 0;
      }
      if (score <= best_score) continue;
      best_score = score;
      result.T_camera_world = pose;
      result.inliers = inliers;
      needed = SamplesNeeded(static_cast<double>(inliers) / count, settings.confidence);
    }
  }
  for (const PointMatch& match : matches) {
    result.inlier[match.index] = best_score > 0 && Gain(camera, result.T_camera_world, match) > 0;
  }
  result.success = result.inliers >= settings.min_inliers;
  return result;
}

}  // namespace alidade
