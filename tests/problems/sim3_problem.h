// Points known to two cameras, each in its own frame and unit, some of them matched wrongly: for
// tests and benchmarks.
#pragma once

#include <vector>

#include "alidade/geometry/sim3_ransac.h"
#include "problems/pose_problem.h"

namespace alidade {

struct Sim3ProblemOptions {
  int matches = 100;
  double outliers = 0;        // share of matches whose point in b is another
  double noise_px = 1.0;      // of both pixels, at the lowest pyramid level
  double depth_noise = 0.01;  // of both points along their rays, share of the depth
  double scale = 1.3;         // of camera b's unit in a's
  uint64_t seed = 1;
};

struct Sim3Problem {
  Camera camera;
  Sim3 truth;  // T_a_b
  std::vector<Sim3Match> matches;
  std::vector<bool> outlier;
};

inline bool InImage(const Camera& camera, const Eigen::Vector3d& p) {
  if (p.z() < 0.2) return false;
  const Eigen::Vector2d pixel = camera.Project(p);
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < camera.width && pixel.y() < camera.height;
}

// The second camera is some 0.4 units and 15 degrees from the first.
inline Sim3Problem MakeSim3Problem(const Sim3ProblemOptions& options) {
  Sim3Problem problem;
  problem.camera = MakeProblemCamera();
  const Camera& camera = problem.camera;
  Random random(options.seed);
  const Se3 motion = Se3::Exp(RandomIncrement(random, 0.25, 0.15));
  problem.truth = {options.scale, motion.R, motion.t};
  const Sim3 T_b_a = problem.truth.Inverse();
  // A point as one camera knows it: where it was seen, at a depth with an error.
  const auto know = [&](const Eigen::Vector3d& p, double sigma, Eigen::Vector3d& known,
                        Eigen::Vector2d& pixel) {
    const double u = random.Gaussian(), v = random.Gaussian(), depth = random.Gaussian();
    pixel = camera.Project(p) + sigma * options.noise_px * Eigen::Vector2d(u, v);
    known = p * (1 + options.depth_noise * depth);
  };
  while (static_cast<int>(problem.matches.size()) < options.matches) {
    const double u = random.Uniform(0, camera.width), v = random.Uniform(0, camera.height);
    const Eigen::Vector3d p_a = camera.Unproject({u, v}, random.Uniform(1, 8));
    const Eigen::Vector3d p_b = T_b_a * p_a;
    if (!InImage(camera, p_b)) continue;
    Sim3Match m;
    m.sigma_a = std::pow(1.2, random.Below(8));
    m.sigma_b = std::pow(1.2, random.Below(8));
    know(p_a, m.sigma_a, m.p_a, m.pixel_a);
    know(p_b, m.sigma_b, m.p_b, m.pixel_b);
    const bool outlier = random.Uniform() < options.outliers;
    if (outlier) {
      const double x = random.Uniform(0, camera.width), y = random.Uniform(0, camera.height);
      m.pixel_b = {x, y};
      m.p_b = camera.Unproject(m.pixel_b, random.Uniform(1, 8) / options.scale);
    }
    problem.matches.push_back(m);
    problem.outlier.push_back(outlier);
  }
  return problem;
}

}  // namespace alidade
