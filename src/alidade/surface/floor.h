// The plane a robot drives on.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <vector>

#include "alidade/surface/dense_view.h"

namespace alidade {

struct Floor {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // unit normal, in the world of the views
  double height = 0;                              // up · p of its points, meters
  double sigma = 0;  // root mean square distance of the readings on it, meters; 0: not measured
  double share = 0;  // of the seen surface that lies on it; 0: not measured

  // World with z up from the floor, its origin below (on) `origin`, and x along the horizontal part
  // of `forward`.
  Se3 FrameFor(const Eigen::Vector3d& origin, const Eigen::Vector3d& forward) const;
};

struct FloorSettings {
  // Between the floor's normal and the given `up`, radians: what is nearer to level than to
  // upright. The up direction of a hand-held camera that looks down is nearly as far off
  // (docs/benchmarks/surface.md).
  double most_tilt = M_PI / 4;
  double below_share = 0.02;  // of the seen surface: wrong readings below the floor
  int samples = 2000;         // of RANSAC: finds a plane with 10 % of the surface with 86 %
};

// The plane with most of the seen surface (in equal cubes, so that near surfaces count no more than
// far ones) that lies below the cameras and has next to nothing below itself (Fischler & Bolles
// 1981; then least squares). `up`: approximate, unit vector. nullopt: no such plane.
std::optional<Floor> FindFloor(const std::vector<DenseView>& views, const Eigen::Vector3d& up,
                               const FloorSettings& settings = {});

}  // namespace alidade
