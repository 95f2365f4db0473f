// A cluttered desk at 0.5 to 1 m distance, with pictures on the wall behind it.
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {

Layout LayOutDesk(SceneBuilder& builder) {
  using Eigen::Vector2d;
  Furnisher shell(builder, 350), furnish(builder, 1000);
  const double pi = std::numbers::pi, height = 2.6;
  const Vector2d a(-2.6, -2.4), b(2.6, -2.4), c(2.6, 2.1), d(-2.6, 2.1);
  AddFloor(shell, a, c, PaintCarpet, 110);
  AddCeiling(shell, a, c, height);
  AddWall(shell, a, b, height, {PaintPlaster, 185});
  AddWall(shell, b, c, height, {PaintPlaster, 178});
  AddWall(shell, c, d, height, {PaintPlaster, 192});
  AddWall(shell, d, a, height, {PaintPlaster, 185});
  builder.AddLamp({0, -0.6, 2.4});
  builder.AddLamp({0.8, 1.0, 2.4});

  const Place top = Place{}.At(0, 0, 0.74);
  furnish.Table({}, 1.8, 0.9, 0.74);
  furnish.Monitor(top.At(-0.1, 0.24, 0, 0.08));
  furnish.Box(top.At(-0.05, -0.14, 0, -0.05), {-0.22, -0.075, 0}, {0.44, 0.15, 0.018},
              {builder.Tone(50), builder.Tone(50), builder.Tone(50), builder.Tone(50),
               furnish.Picture(PaintKeyboard, 0.44, 0.15), -1});
  furnish.Pages(top.At(0.36, -0.2, 0.001), 3);
  furnish.Pages(top.At(-0.55, -0.2, 0.001), 2);
  furnish.BookPile(top.At(0.68, 0.24, 0, 0.3), 6);
  furnish.BookPile(top.At(-0.72, -0.05, 0, -0.2), 3);
  furnish.BookRow(top.At(-0.62, 0.3, 0, 0.1), 0.36, 0.2, 0.28);
  furnish.Mug(top.At(0.3, 0.08, 0));
  furnish.Mug(top.At(-0.36, 0.06, 0));
  furnish.PottedPlant(top.At(0.42, 0.32, 0), 0.36);
  furnish.Cartons(top.At(0.66, -0.1, 0, 0.4), 1);
  furnish.Chair(Place{}.At(1.3, -0.3, 0, -1.2));

  // The wall behind the desk.
  const Place wall = AtWall(c, d, 2.6);
  shell.Poster(wall, -1.5, 1.5, 0.6, 0.85);
  shell.Poster(wall, -0.55, 1.35, 0.7, 0.5);
  shell.Hang(wall, 0.5, 1.45, 1.1, 0.8, shell.Picture(PaintBoard, 1.1, 0.8), 0.02);
  shell.Poster(wall, 1.6, 1.4, 0.5, 0.7);
  shell.Shelf(AtWall(c, d, 0.7, 0.16), 1.0, 0.3, 1.1);
  shell.Cabinet(AtWall(c, d, 4.6, 0.22), 0.8, 0.4, 0.75, 3, 1);
  shell.Poster(AtWall(b, c, 3.2), 0, 1.4, 0.6, 0.8);
  shell.Poster(AtWall(d, a, 1.3), 0, 1.4, 0.8, 0.6);
  shell.PottedPlant(AtWall(b, c, 4.0, 0.5), 1.3);
  shell.Cartons(AtWall(d, a, 0.6, 0.4), 3);

  std::vector<PathKnot> knots;
  constexpr int kKnots = 60;
  for (int i = 0; i < kKnots; ++i) {
    const double angle = 2 * pi * i / kKnots;
    PathKnot knot;
    knot.position = {0.55 * std::sin(3 * angle), -0.86 + 0.2 * std::sin(2 * angle + 2),
                     1.24 + 0.13 * std::sin(4 * angle + 1)};
    const Eigen::Vector3d target(0.35 * std::sin(5 * angle + 0.5), 0.25,
                                 0.86 + 0.1 * std::sin(2 * angle));
    const Eigen::Vector3d to = target - knot.position;
    knot.yaw = std::atan2(to.y(), to.x());
    knot.pitch = std::atan2(to.z(), to.head<2>().norm());
    knots.push_back(knot);
  }
  const std::vector<Walk> walks = {{{1.6, 1.0}, {-1.6, 1.0}, {-1.6, 1.35}, {1.6, 1.35}}};
  ShakeSettings shake;
  shake.position = 0.008;
  shake.rotation = 0.026;
  const TableTop table = {{0, -0.12, 0.76}, 0.5, 0.2};
  return {knots, 20.0, 0, shake, walks, table};
}

}  // namespace alidade
