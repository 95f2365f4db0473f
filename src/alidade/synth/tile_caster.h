// Casts the rays of one tile of the picture against what may be seen in it.
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

  // Keeps references to all.
  TileCaster(const Scene& scene, const std::vector<RectPlane>& planes, const Camera& camera,
             const Shutter& shutter, const StageView& stage, const TileList& list);

  // To be called before a row's rays are cast.
  void SetRow(int row);
  // 1/z and place in the list (-1: nothing) of what the row's rays (x/z, y/z) meet first, kTile of
  // them.
  void Row(const float* ray_x, const float* ray_y, float* inverse_z, int* which) const;
  // The place in the list of what one ray meets first.
  int Cast(float x, float y) const;
  // Whether the ray meets the list's `which`, hidden or not. Rectangles are convex: they need no
  // look.
  bool Meets(int which, float x, float y) const;
  // Grey level where the ray meets the list's `which`, filtered as a pixel gathers it.
  float Shade(int which, float x, float y) const;
  // Index of the rectangle, or their number plus that of the quadric; -1: nothing.
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
  std::vector<char> is_rect_;       // one for each of the list
  std::vector<RectForms> forms_;    // likewise, for the row set
  std::vector<QuadricView> views_;  // likewise
};

}  // namespace alidade
