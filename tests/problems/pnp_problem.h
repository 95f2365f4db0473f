// Landmarks and where a camera of known pose sees them: shared by tests and benchmarks.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

struct PnpProblemSettings {
  int matches = 200;
  double outliers = 0;  // share of the matches
  double noise_px = 0;  // standard deviation of each coordinate
  bool planar = false;  // landmarks on a plane of the world
  uint64_t seed = 1;
};

struct PnpProblem {
  Camera camera;
  Se3 T_camera_world;
  std::vector<Eigen::Vector3d> p_world;
  std::vector<Eigen::Vector2d> pixels;
  std::vector<bool> outlier;
};

inline PnpProblem MakePnpProblem(const PnpProblemSettings& settings) {
  Random random(settings.seed, 78);
  PnpProblem problem;
  Camera& camera = problem.camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 525;
  camera.fy = 530;
  camera.cx = 316;
  camera.cy = 244;
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = random.Gaussian();
  problem.T_camera_world = Se3::Exp(xi);
  const Se3 T_world_camera = problem.T_camera_world.Inverse();
  Eigen::Vector3d normal;  // of the plane n' p = 3 in the camera's frame
  normal << random.Uniform(-0.5, 0.5), random.Uniform(-0.5, 0.5), 1;
  for (int i = 0; i < settings.matches; ++i) {
    const double u = random.Uniform(0, 639), v = random.Uniform(0, 479);
    const Eigen::Vector3d ray = camera.Unproject({u, v});
    const double depth = settings.planar ? 3 / normal.dot(ray) : random.Uniform(1, 8);
    const bool outlier = random.Uniform() < settings.outliers;
    Eigen::Vector2d pixel(u + settings.noise_px * random.Gaussian(), v);
    pixel.y() += settings.noise_px * random.Gaussian();
    if (outlier) {
      pixel.x() = random.Uniform(0, 639);
      pixel.y() = random.Uniform(0, 479);
    }
    problem.p_world.push_back(T_world_camera * (depth * ray));
    problem.pixels.push_back(pixel);
    problem.outlier.push_back(outlier);
  }
  return problem;
}

}  // namespace alidade
