// Landmarks seen by one camera, with the pose they were made from: for tests and benchmarks.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/optimize/pose_only.h"

namespace alidade {

struct PoseProblemOptions {
  int matches = 300;
  double stereo = 0.5;                  // share of matches with a u_right
  double outliers = 0;                  // share of matches moved anywhere in the image
  double noise_px = 1.0;                // standard deviation at the lowest pyramid level
  double min_depth = 1, max_depth = 8;  // metres
  uint64_t seed = 1;
};

struct PoseProblem {
  Camera camera;
  Se3 truth;  // T_camera_world
  std::vector<PoseMatch> matches;
  std::vector<bool> outlier;
};

inline Camera MakeProblemCamera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 520;
  camera.fy = 518;
  camera.cx = 321.5;
  camera.cy = 243.2;
  camera.baseline = 0.1;
  return camera;
}

// u, v, u_right of a point in the camera frame, without noise.
inline Eigen::Vector3d ProjectStereo(const Camera& camera, const Eigen::Vector3d& p) {
  const Eigen::Vector2d uv = camera.Project(p);
  return {uv.x(), uv.y(), uv.x() - camera.bf() / p.z()};
}

inline Eigen::Vector3d RandomVector(Random& random, double sigma) {
  const double x = random.Gaussian(), y = random.Gaussian(), z = random.Gaussian();
  return sigma * Eigen::Vector3d(x, y, z);
}

// Error of (u, v, u_right): column, row and disparity are each off by `sigma`, independently.
inline Eigen::Vector3d RandomPixelError(Random& random, double sigma) {
  const Eigen::Vector3d e = RandomVector(random, sigma);
  return {e.x(), e.y(), e.x() - e.z()};
}

inline Vector6d RandomIncrement(Random& random, double sigma_translation, double sigma_rotation) {
  Vector6d xi;
  xi.head<3>() = RandomVector(random, sigma_translation);
  xi.tail<3>() = RandomVector(random, sigma_rotation);
  return xi;
}

inline PoseProblem MakePoseProblem(const PoseProblemOptions& options) {
  PoseProblem problem;
  Random random(options.seed);
  problem.camera = MakeProblemCamera();
  problem.truth = Se3::Exp(RandomIncrement(random, 1.0, 0.5));
  const Se3 T_world_camera = problem.truth.Inverse();
  for (int i = 0; i < options.matches; ++i) {
    const double u = random.Uniform(0, problem.camera.width);
    const double v = random.Uniform(0, problem.camera.height);
    const double z = random.Uniform(options.min_depth, options.max_depth);
    const Eigen::Vector3d p = problem.camera.Unproject({u, v}, z);
    const double sigma = std::pow(1.2, random.Below(8));  // pyramid level
    PoseMatch m;
    m.p_world = T_world_camera * p;
    m.pixel = ProjectStereo(problem.camera, p) + RandomPixelError(random, sigma * options.noise_px);
    m.inv_sigma2 = m.inv_sigma2_right = 1 / (sigma * sigma);
    if (random.Uniform() >= options.stereo) {
      m.pixel.z() = std::numeric_limits<double>::quiet_NaN();
    }
    const bool outlier = random.Uniform() < options.outliers;
    if (outlier) {
      m.pixel.x() = random.Uniform(0, problem.camera.width);
      m.pixel.y() = random.Uniform(0, problem.camera.height);
    }
    problem.matches.push_back(m);
    problem.outlier.push_back(outlier);
  }
  return problem;
}

}  // namespace alidade
