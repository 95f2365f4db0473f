// Two views of made-up points with exact truth, of the kinds a monocular start meets: shared by
// tests and benchmarks.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

enum class SceneKind {
  kGeneral,       // points at depths of 2 to 8 m
  kPlanar,        // a wall 3 to 5 m away, turned up to 40 degrees
  kNearlyPlanar,  // the wall with relief of 2 % of its distance
  kRotation,      // the camera only turns
  kLowParallax,   // general, but moved by 0.4 % of the depth
};

struct TwoViewProblemSettings {
  SceneKind kind = SceneKind::kGeneral;
  int matches = 300;
  double outliers = 0.4;  // share of the matches
  double noise_px = 1;    // standard deviation of each coordinate in both images
  double baseline = 0;    // metres; 0: 0.3 to 0.8 drawn
  uint64_t seed = 1;
};

struct TwoViewProblem {
  Camera camera;
  Se3 T_b_a;  // in metres
  std::vector<Eigen::Vector2d> a, b;
  std::vector<Eigen::Vector3d> p_a;  // of each match; outliers' too
  std::vector<bool> outlier;
};

inline Eigen::Vector3d RandomDirection(Random& random) {
  const double x = random.Gaussian(), y = random.Gaussian();
  return Eigen::Vector3d(x, y, random.Gaussian()).normalized();
}

inline TwoViewProblem MakeTwoViewProblem(const TwoViewProblemSettings& settings) {
  Random random(settings.seed, 77);
  TwoViewProblem problem;
  Camera& camera = problem.camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 525;
  camera.fy = 530;
  camera.cx = 316;
  camera.cy = 244;

  const bool wall =
      settings.kind == SceneKind::kPlanar || settings.kind == SceneKind::kNearlyPlanar;
  // A wall n' p = distance in the frame of a.
  const double tilt = random.Uniform(0, 40) * std::numbers::pi / 180,
               turn = random.Uniform(0, 2 * std::numbers::pi);
  const Eigen::Vector3d normal(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn),
                               std::cos(tilt));
  const double distance = random.Uniform(3, 5);

  const double angle = random.Uniform(0, 12) * std::numbers::pi / 180;
  problem.T_b_a.R = ExpSo3(angle * RandomDirection(random));
  double baseline = settings.baseline > 0 ? settings.baseline : random.Uniform(0.3, 0.8);
  if (settings.kind == SceneKind::kLowParallax) baseline = 0.02;
  if (settings.kind == SceneKind::kRotation) baseline = 0;
  problem.T_b_a.t = baseline * RandomDirection(random);

  const auto inside = [&](const Eigen::Vector2d& p) {
    return p.x() >= 0 && p.y() >= 0 && p.x() <= camera.width - 1 && p.y() <= camera.height - 1;
  };
  const auto random_pixel = [&] {
    const double x = random.Uniform(0, camera.width - 1);
    return Eigen::Vector2d(x, random.Uniform(0, camera.height - 1));
  };
  const auto noisy = [&](Eigen::Vector2d p) {
    p.x() += settings.noise_px * random.Gaussian();
    p.y() += settings.noise_px * random.Gaussian();
    return p;
  };
  while (static_cast<int>(problem.a.size()) < settings.matches) {
    const Eigen::Vector2d pixel = random_pixel();
    const Eigen::Vector3d ray = camera.Unproject(pixel);
    double depth = random.Uniform(2, 8);
    if (wall) {
      const double relief =
          settings.kind == SceneKind::kNearlyPlanar ? 0.02 * random.Gaussian() : 0;
      depth = distance * (1 + relief) / normal.dot(ray);
    }
    const Eigen::Vector3d p = depth * ray, seen = problem.T_b_a * p;
    if (depth < 0.3 || depth > 30 || seen.z() < 0.3 || !inside(camera.Project(seen))) continue;
    const bool outlier = random.Uniform() < settings.outliers;
    problem.a.push_back(noisy(pixel));
    problem.b.push_back(outlier ? random_pixel() : noisy(camera.Project(seen)));
    problem.p_a.push_back(p);
    problem.outlier.push_back(outlier);
  }
  return problem;
}

}  // namespace alidade
