// Cameras and points with what they see of each other, moved away from the truth: for tests and
// benchmarks.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "alidade/optimize/bundle_adjustment.h"
#include "problems/pose_problem.h"

namespace alidade {

enum class BundleScene {
  kRoom,     // cameras on a path along a volume of points
  kWall,     // the same, all points within a millimetre of one plane
  kTurning,  // cameras that only turn, points 10 times as far
  kRing,     // a closed path, a tenth of it walked twice, looking out at walls all around
};

struct BundleProblemOptions {
  BundleScene scene = BundleScene::kRoom;
  int fixed_cameras = 2;  // the first ones
  int free_cameras = 8;
  int points = 300;
  double path_length = 4;        // metres
  int min_track = 2;             // a point is seen by at least so many cameras,
  int max_track = 8;             // and at most so many, next to each other on the path
  double stereo = 0.5;           // share of observations with a u_right
  double outliers = 0;           // share of observations moved
  double outlier_px = 20;        // by up to this, each way
  double noise_px = 1.0;         // standard deviation at the lowest pyramid level
  double point_error = 0.05;     // standard deviation of the start, metres (× depth / 4 m)
  double camera_error = 0.02;    // of a free camera's start, metres
  double rotation_error = 0.01;  // of a free camera's start, radians
  uint64_t seed = 1;
};

// The camera at place s in [0, 1] of its path: sideways, turning by half a radian; or around.
inline Se3 BundleCameraAt(BundleScene scene, double path_length, double s) {
  if (scene == BundleScene::kRing) {
    const double angle = 1.1 * 2 * std::numbers::pi * s;
    const double radius = path_length / (1.1 * 2 * std::numbers::pi);
    const Eigen::Matrix3d R = ExpSo3(Eigen::Vector3d(0.1 * std::sin(9 * s), 0, 0)) *
                              ExpSo3(Eigen::Vector3d(0, -angle, 0));
    const Eigen::Vector3d centre(radius * std::sin(angle), 0.2 * std::sin(8 * s),
                                 radius * std::cos(angle));
    return {R, -(R * centre)};
  }
  const Eigen::Vector3d turn(0.1 * std::sin(9 * s), 0.5 * (s - 0.5), 0.1 * std::cos(7 * s));
  const Eigen::Vector3d centre =
      scene == BundleScene::kTurning
          ? Eigen::Vector3d(0, 0, 0)
          : Eigen::Vector3d(path_length * s, 0.2 * std::sin(8 * s), 0.3 * std::sin(5 * s));
  const Eigen::Matrix3d R = ExpSo3(turn);
  return {R, -(R * centre)};
}

// The point at share `s` of all, in the order of the map: of a ring they come as the path does.
inline Eigen::Vector3d RandomBundlePoint(BundleScene scene, double path_length, double s,
                                         Random& random) {
  const double x = random.Uniform(-2, path_length + 2), y = random.Uniform(-2, 2),
               z = random.Uniform(2, 7);
  switch (scene) {
    case BundleScene::kWall:
      return {x, y, 4 + 0.1 * x + 0.0005 * (z - 4)};
    case BundleScene::kTurning:
      return 10 * Eigen::Vector3d(x - 2, y, z);
    case BundleScene::kRing: {
      const double angle = 2 * std::numbers::pi * (s + 0.1 * (x + 2) / (path_length + 4));
      const double radius = path_length / (1.1 * 2 * std::numbers::pi) + z;
      return {radius * std::sin(angle), y, radius * std::cos(angle)};
    }
    default:
      return {x, y, z};
  }
}

inline BundleProblem MakeBundleProblem(const BundleProblemOptions& options) {
  BundleProblem problem;
  problem.camera = MakeProblemCamera();
  Random random(options.seed);
  const int cameras = options.fixed_cameras + options.free_cameras;
  std::vector<Se3> truth;
  for (int i = 0; i < cameras; ++i) {
    truth.push_back(BundleCameraAt(options.scene, options.path_length, (i + 0.5) / cameras));
    problem.fixed.push_back(i < options.fixed_cameras);
  }
  // Fixed cameras are spread over the path, as the old keyframes around a local window are. A ring
  // is a whole map, in the order in which it was made.
  std::vector<int> order;
  for (int i = 0; i < cameras; ++i) order.push_back(i);
  for (int i = options.scene == BundleScene::kRing ? 0 : cameras - 1; i > 0; --i) {
    std::swap(order[i], order[random.Below(i + 1)]);
  }

  while (static_cast<int>(problem.points.size()) < options.points) {
    const Eigen::Vector3d p_world =
        RandomBundlePoint(options.scene, options.path_length,
                          static_cast<double>(problem.points.size()) / options.points, random);
    std::vector<int> seen;
    for (int i = 0; i < cameras; ++i) {
      const Eigen::Vector3d p = truth[i] * p_world;
      if (p.z() < 0.3) continue;
      const Eigen::Vector2d pixel = problem.camera.Project(p);
      if (pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < problem.camera.width &&
          pixel.y() < problem.camera.height) {
        seen.push_back(i);
      }
    }
    const int spread = std::max(1, options.max_track - options.min_track + 1);
    const int count = std::min(static_cast<int>(seen.size()),
                               options.min_track + static_cast<int>(random.Below(spread)));
    if (count < options.min_track) continue;
    const int first = static_cast<int>(random.Below(seen.size() - count + 1));
    const int index = static_cast<int>(problem.points.size());
    double depth = 0;
    for (int n = 0; n < count; ++n) {
      const int i = seen[first + n];
      const Eigen::Vector3d p = truth[i] * p_world;
      const double sigma = std::pow(1.2, random.Below(8));  // pyramid level
      BundleObservation o;
      o.camera = order[i];
      o.point = index;
      o.pixel =
          ProjectStereo(problem.camera, p) + RandomPixelError(random, sigma * options.noise_px);
      o.inv_sigma2 = o.inv_sigma2_right = 1 / (sigma * sigma);
      if (random.Uniform() >= options.stereo) {
        o.pixel.z() = std::numeric_limits<double>::quiet_NaN();
      }
      if (random.Uniform() < options.outliers) {
        o.pixel.x() += random.Uniform(-options.outlier_px, options.outlier_px);
        o.pixel.y() += random.Uniform(-options.outlier_px, options.outlier_px);
      }
      problem.observations.push_back(o);
      depth = std::max(depth, p.z());
    }
    problem.points.push_back(p_world + RandomVector(random, options.point_error * depth / 4));
  }
  problem.T_camera_world.resize(cameras);
  for (int i = 0; i < cameras; ++i) {
    const Vector6d xi = RandomIncrement(random, options.camera_error, options.rotation_error);
    problem.T_camera_world[order[i]] = problem.fixed[order[i]] ? truth[i] : Se3::Exp(xi) * truth[i];
  }
  return problem;
}

}  // namespace alidade
