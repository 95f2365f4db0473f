// A bare table in a bare room: few features except on the moved objects.
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {

Layout LayOutTable(SceneBuilder& builder) {
  using Eigen::Vector2d;
  Furnisher furnish(builder, 350);
  const double pi = std::numbers::pi, height = 2.6;
  const Vector2d a(-2.8, -2.6), b(2.8, -2.6), c(2.8, 2.2), d(-2.8, 2.2);
  AddFloor(furnish, a, c, PaintPlanks, 120);
  AddCeiling(furnish, a, c, height);
  AddWall(furnish, a, b, height, {PaintPlaster, 185});
  AddWall(furnish, b, c, height, {PaintPlaster, 178});
  AddWall(furnish, c, d, height, {PaintPlaster, 170});
  AddWall(furnish, d, a, height, {PaintPlaster, 185});
  builder.AddLamp({-0.5, -0.6, 2.4});
  builder.AddLamp({0.8, 1.0, 2.4});

  // A bright table top without texture; panels along the wall behind, a switch, a mug.
  const int top = builder.Tone(215), leg = builder.Tone(120);
  furnish.Box({}, {-0.8, -0.45, 0.705}, {1.6, 0.9, 0.035}, BoxFaces::All(top));
  for (const double x : {-0.74, 0.68}) {
    for (const double y : {-0.39, 0.33})
      furnish.Box({}, {x, y, 0}, {0.06, 0.06, 0.705}, BoxFaces::All(leg));
  }
  furnish.Shade({}, {-0.8, -0.45, 0.69}, {1.6, 0.9, 0.05});
  const Place wall = AtWall(c, d, 2.8);
  for (int i = -2; i <= 2; ++i) {
    furnish.Hang(wall, 1.05 * i, 0.55, 1.0, 1.0, furnish.Material(PaintWood, 1.0, 1.0, 140), 0.03);
  }
  furnish.Hang(wall, 0.9, 1.3, 0.09, 0.09, furnish.Picture(PaintCover, 0.09, 0.09, 2), 0.012);
  furnish.Mug(Place{}.At(-0.55, 0.2, 0.74));
  // Behind the camera, visible when it turns.
  furnish.Cabinet(AtWall(a, b, 2.0, 0.24), 1.2, 0.45, 0.85, 3, 2);
  furnish.Poster(AtWall(a, b, 4.0), 0, 1.6, 0.7, 0.95);

  std::vector<PathKnot> knots;
  constexpr int kKnots = 48;
  for (int i = 0; i < kKnots; ++i) {
    const double angle = 2 * pi * i / kKnots;
    PathKnot knot;
    knot.position = {0.75 * std::sin(angle), -1.05 + 0.12 * std::sin(2 * angle + 1),
                     1.2 + 0.12 * std::sin(2 * angle)};
    const Eigen::Vector3d to =
        Eigen::Vector3d(0.2 * std::sin(3 * angle), 0.15, 0.88) - knot.position;
    knot.yaw = std::atan2(to.y(), to.x());
    knot.pitch = std::atan2(to.z(), to.head<2>().norm());
    knots.push_back(knot);
  }
  const std::vector<Walk> walks = {{{1.8, 1.0}, {-1.8, 1.0}, {-1.8, 1.5}, {1.8, 1.5}}};
  const TableTop table = {{0, -0.05, 0.74}, 0.4, 0.16, {0.35, 0.85, 0.4}, 0.75};
  return {knots, 12.0, 0, {}, walks, table};
}

}  // namespace alidade
