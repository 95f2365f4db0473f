#include "alidade/geometry/pnp.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
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

// 1 for a perfect match, falling to 0 at the largest allowed error; 0 beyond it and behind the
// camera.
double Gain(const Camera& camera, const Se3& T_camera_world, const PointMatch& match) {
  const Eigen::Vector3d p = T_camera_world * match.p_world;
  if (!(p.z() > 0)) return 0;
  const double squared = (camera.Project(p) - match.pixel).squaredNorm() * match.inverse_squared;
  return squared < 1 ? 1 - squared : 0;
}

struct ScoredPose {
  Se3 T_camera_world;
  double score = 0;  // MSAC score (Torr & Zisserman 2000)
  int inliers = 0;
};

ScoredPose Score(const Camera& camera, const Se3& T_camera_world,
                 std::span<const PointMatch> matches) {
  ScoredPose scored{T_camera_world};
  for (const PointMatch& match : matches) {
    const double gain = Gain(camera, T_camera_world, match);
    scored.score += gain;
    scored.inliers += gain > 0;
  }
  return scored;
}

// One Gauss-Newton step over the inliers.
Se3 Step(const Camera& camera, const Se3& T, std::span<const PointMatch> matches) {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  for (const PointMatch& match : matches) {
    const Eigen::Vector3d p = T * match.p_world;
    if (!(p.z() > 0)) continue;
    const Eigen::Vector2d error = camera.Project(p) - match.pixel;
    if (!(error.squaredNorm() * match.inverse_squared < 1)) continue;
    Eigen::Matrix<double, 2, 6> J;  // of the left increment: A [I, -[p]x]
    J.leftCols<3>() << camera.fx / p.z(), 0, -camera.fx * p.x() / (p.z() * p.z()), 0,
        camera.fy / p.z(), -camera.fy * p.y() / (p.z() * p.z());
    J.rightCols<3>() = -J.leftCols<3>() * Skew(p);
    H += match.inverse_squared * J.transpose() * J;
    g += match.inverse_squared * J.transpose() * error;
  }
  return Se3::Exp(-H.llt().solve(g)) * T;
}

// Local optimization: refines the pose over all its inliers, which usually adds inliers (LO-RANSAC,
// Chum, Matas & Kittler 2003).
ScoredPose Polish(const Camera& camera, ScoredPose best, std::span<const PointMatch> matches) {
  constexpr int kSteps = 5;
  for (int k = 0; k < kSteps; ++k) {
    const ScoredPose scored = Score(camera, Step(camera, best.T_camera_world, matches), matches);
    if (!(scored.score > best.score)) break;
    best = scored;
  }
  return best;
}

}  // namespace

void PnpSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("pnp settings: ") + what);
  };
  require(max_iterations > 0, "max_iterations must be positive");
  require(min_iterations >= 0, "min_iterations must not be negative");
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

  Random random(settings.seed);
  ScoredPose best;
  double needed = settings.max_iterations;
  for (int iteration = 0; iteration < settings.max_iterations && iteration < needed; ++iteration) {
    const std::vector<int> sample = random.Sample(3, count);
    Eigen::Vector3d points[3], rays[3];
    for (int k = 0; k < 3; ++k) {
      points[k] = matches[sample[k]].p_world;
      rays[k] = camera.Unproject(matches[sample[k]].pixel).normalized();
    }
    for (const Se3& pose : SolveP3p(points, rays)) {
      const ScoredPose scored = Score(camera, pose, matches);
      if (scored.score <= best.score) continue;
      best = Polish(camera, scored, matches);
      needed = std::max<double>(
          settings.min_iterations,
          SamplesNeeded(static_cast<double>(best.inliers) / count, settings.confidence));
    }
  }
  result.T_camera_world = best.T_camera_world;
  result.inliers = best.inliers;
  for (const PointMatch& match : matches) {
    result.inlier[match.index] = best.score > 0 && Gain(camera, result.T_camera_world, match) > 0;
  }
  result.success = result.inliers >= settings.min_inliers;
  return result;
}

}  // namespace alidade
