// The true surface of rendered scenes, beside which meshes and floor grids are judged.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "alidade/surface/dense_view.h"
#include "alidade/surface/occupancy.h"
#include "alidade/surface/voxel_blocks.h"
#include "alidade/synth/recording.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {

// Distance to the surfaces of a rendered scene, without people.
class SurfaceTruth {
 public:
  explicit SurfaceTruth(const SynthSettings& settings) {
    SceneBuilder builder(settings.seed);
    LayOut(settings.scene, builder);
    scene_ = builder.Build();
  }

  // Meters, from a point in the scene's world (z up, floor at 0).
  double Distance(const Eigen::Vector3d& p) const {
    double least = INFINITY;
    for (const Rect& rect : scene_.rects) least = std::min(least, ToRect(rect, p));
    for (const Quadric& quadric : scene_.quadrics) least = std::min(least, ToQuadric(quadric, p));
    return least;
  }

 private:
  static double ToRect(const Rect& rect, const Eigen::Vector3d& p) {
    const Eigen::Vector3d d = p - rect.origin;
    const double u = std::clamp(d.dot(rect.right) / rect.right.squaredNorm(), 0.0, 1.0),
                 v = std::clamp(d.dot(rect.down) / rect.down.squaredNorm(), 0.0, 1.0);
    return (d - u * rect.right - v * rect.down).norm();
  }
  // To first order: |f| / |grad f| of the implicit function of the ball or frustum.
  static double ToQuadric(const Quadric& quadric, const Eigen::Vector3d& p) {
    if ((p - quadric.centre).norm() > quadric.radius + 0.5) return INFINITY;
    const Eigen::Vector3d q = quadric.from_world * (p - quadric.origin);
    Eigen::Vector3d gradient;
    double f = 0;
    if (quadric.kind == Quadric::Kind::kBall) {
      f = q.norm() - 1;
      gradient = q.normalized();
    } else {
      if (q.z() < -0.05 || q.z() > 1.05) return INFINITY;
      const double across = q.head<2>().norm(), slope = quadric.top - 1;
      f = across - (1 + slope * q.z());
      gradient << q.head<2>() / std::max(1e-9, across), -slope;
    }
    return std::abs(f) / (quadric.from_world.transpose() * gradient).norm();
  }

  Scene scene_;
};

// Whether a surface is within `far` of the vertical line from `low` to `high` over `p` on the
// floor.
inline bool StandsThere(const SurfaceTruth& truth, const Eigen::Vector3d& p, double low,
                        double high, double far) {
  for (double z = low; z <= high; z += far) {
    if (truth.Distance({p.x(), p.y(), z}) <= far) return true;
  }
  return false;
}

struct GridScore {
  int free = 0, free_right = 0;    // cells whose floor was seen, with nothing around them
  int walls = 0, walls_right = 0;  // cells in which something within the robot's height was seen
  int walls_free = 0;              // of them: free, and no occupied cell around: a robot would hit
  double FreeShare() const { return 1.0 * free_right / std::max(1, free); }
  double WallShare() const { return 1.0 * walls_right / std::max(1, walls); }
};

// `views`: with exact depth and true poses. Only depth within `range` counts. `T_grid_scene`: of
// the grid's frame. All within one cell.
inline GridScore ScoreGrid(const OccupancyPicture& picture, const OccupancySettings& settings,
                           const Se3& T_grid_scene, const std::vector<DenseView>& views,
                           double range) {
  constexpr double kFloor = 0.005;             // meters: exact depth of the floor
  std::unordered_map<uint64_t, uint8_t> seen;  // by cell; 1: floor, 2: something to hit
  const auto cell_of = [&](double v) { return static_cast<int>(std::floor(v / settings.cell)); };
  for (const DenseView& view : views) {
    for (int y = 0; y < view.depth.rows; y += 2) {
      for (int x = 0; x < view.depth.cols; x += 2) {
        const double z = view.depth(y, x);
        if (!(z > 0 && z <= range)) continue;
        const Eigen::Vector3d p_scene = view.T_world_camera * view.camera.Unproject({x, y}, z);
        const Eigen::Vector3d p = T_grid_scene * p_scene;
        const uint64_t key = KeyOf({cell_of(p.x()), cell_of(p.y()), 0});
        if (std::abs(p_scene.z()) < kFloor) seen[key] |= 1;
        if (p_scene.z() > settings.clearance && p_scene.z() < settings.height) seen[key] |= 2;
      }
    }
  }
  const int left = cell_of(picture.x + 0.5 * settings.cell),
            low = cell_of(picture.y + 0.5 * settings.cell);
  const auto state = [&](int x, int y) -> int {
    const int column = x - left, row = y - low;
    const bool inside = column >= 0 && row >= 0 && column < picture.width && row < picture.height;
    return inside ? picture.At(column, row) : -1;
  };
  GridScore score;
  for (const auto& [key, kind] : seen) {
    const Eigen::Vector3i at = PlaceOf(key);
    bool hit_near = false, occupied_near = false;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto near = seen.find(KeyOf(at + Eigen::Vector3i(dx, dy, 0)));
        hit_near = hit_near || (near != seen.end() && (near->second & 2) != 0);
        occupied_near = occupied_near || state(at.x() + dx, at.y() + dy) == 100;
      }
    }
    const int here = state(at.x(), at.y());
    if ((kind & 2) != 0) {
      ++score.walls;
      score.walls_right += occupied_near ? 1 : 0;
      score.walls_free += here == 0 && !occupied_near ? 1 : 0;
    } else if (!hit_near) {
      ++score.free;
      score.free_right += here == 0 ? 1 : 0;
    }
  }
  return score;
}

}  // namespace alidade
