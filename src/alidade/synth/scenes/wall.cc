// One wall fills the view: all visible points are within a few centimeters of a plane.
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {

Layout LayOutWall(SceneBuilder& builder) {
  using Eigen::Vector2d;
  Furnisher furnish(builder, 450);
  const double pi = std::numbers::pi, height = 3.6;
  const Vector2d a(-5.5, -5), b(5.5, -5), c(5.5, 0), d(-5.5, 0);
  Furnisher coarse(builder, 200);
  AddFloor(coarse, a, c, PaintPlanks, 130);
  AddCeiling(coarse, a, c, height);
  AddWall(coarse, a, b, height, {PaintPlaster, 180});
  AddWall(coarse, b, c, height, {PaintPlaster, 180});
  AddWall(furnish, c, d, height, {PaintPlaster, 190});
  AddWall(coarse, d, a, height, {PaintPlaster, 180});
  for (const double x : {-3.0, 0.0, 3.0}) builder.AddLamp({x, -1.6, 3.4});

  // x from the middle to the right, z up, size; posters unless noted.
  const Place wall = AtWall(c, d, 5.5);
  constexpr double kPosters[][4] = {
      {-4.2, 1.5, 0.7, 0.95},   {-3.2, 2.1, 0.6, 0.45}, {-3.1, 1.15, 0.55, 0.75},
      {-1.0, 2.05, 0.75, 0.55}, {-0.75, 1.1, 0.6, 0.8}, {0.2, 1.75, 0.6, 0.85},
      {0.95, 1.05, 0.5, 0.4},   {1.1, 2.2, 0.7, 0.5},   {3.0, 1.9, 0.6, 0.8},
      {3.1, 0.9, 0.7, 0.5},     {4.0, 1.5, 0.6, 0.9}};
  for (const auto& p : kPosters) furnish.Poster(wall, p[0], p[1], p[2], p[3]);
  furnish.Hang(wall, -2.1, 1.6, 1.3, 0.95, furnish.Picture(PaintBoard, 1.3, 0.95), 0.02);
  // A panel of bare bricks.
  furnish.Hang(wall, 1.95, 1.5, 0.85, 1.5, furnish.Material(PaintBricks, 0.85, 1.5, 120), 0.008);
  for (const double x : {-2.75, -0.1, 1.35, 2.5}) {  // pinned sheets of paper
    furnish.Hang(wall, x, 1.45 + 0.2 * std::sin(5 * x), 0.21, 0.297,
                 furnish.Picture(PaintPage, 0.21, 0.297), 0.002);
  }
  for (const double x : {-3.8, -1.5, 0.55, 2.55, 3.6}) {  // sockets and switches
    furnish.Hang(wall, x, 0.6 + 0.2 * std::cos(x), 0.08, 0.08,
                 furnish.Picture(PaintCover, 0.08, 0.08, 2), 0.012);
  }

  std::vector<PathKnot> knots;
  constexpr int kKnots = 60;
  for (int i = 0; i < kKnots; ++i) {
    const double angle = 2 * pi * i / kKnots;
    PathKnot knot;
    knot.position = {2.0 * std::sin(angle), -1.9 + 0.3 * std::sin(3 * angle + 1),
                     1.5 + 0.3 * std::sin(2 * angle)};
    knot.yaw = pi / 2 + 0.33 * std::sin(5 * angle + 0.4);
    knot.pitch = 0.12 * std::sin(4 * angle + 2);
    knots.push_back(knot);
  }
  const std::vector<Walk> walks = {{{3.2, -0.55}, {-3.2, -0.55}, {-3.2, -0.75}, {3.2, -0.75}}};
  return {knots, 20.0, 0, {}, walks, {}};
}

}  // namespace alidade
