// Casts the rays of one image tile against its visible items.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/synth/quadric_ray.h"
#include "alidade/synth/scene.h"
#include "alidade/synth/stage.h"

namespace alidade {

class TileCaster {
 public:
  static constexpr int kTile = 16;  // pixels, side of a tile

  // Keeps references to all arguments.
  TileCaster(const Scene& scene, const std::vector<RectPlane>& planes, const Camera& camera,
             const Shutter& shutter, const StageView& stage, const TileList& list);

  // Must be called before casting rays of a row.
  void SetRow(int row);
  // 1/z and list index (-1: nothing) of the first hits of the row's kTile rays (x/z, y/z).
  void Row(const float* ray_x, const float* ray_y, float* inverse_z, int* which) const;
  // List index of the first hit of one ray; -1: nothing.
  int Cast(float x, float y) const;
  // True if the ray hits list item `which`, occluded or not. Always true for rectangles: they are
  // convex, so the mean of rays that hit one hits it too.
  bool Meets(int which, float x, float y) const;
  // Filtered gray level where the ray hits list item `which`.
  float Shade(int which, float x, float y) const;
  // Index of the rectangle, or number of rectangles + index of the quadric; -1: nothing.
  int Surface(int which) const;
  bool IsActor(int which) const;

 private:
  const Quadric& QuadricOf(int which) const;
  float ShadeRect(int which, float x, float y) const;
  float ShadeRound(int which, float x, float y) const;

  const Scene& scene_;
  const std::vector<RectPlane>& planes_;
  const Camera& camera_;
  const Shutter& shutter_;
  const StageView& stage_;
  const TileList& list_;
  std::vector<char> is_rect_;       // one per list item
  std::vector<RectForms> forms_;    // likewise, for the current row
  std::vector<QuadricView> views_;  // likewise
};

}  // namespace alidade
