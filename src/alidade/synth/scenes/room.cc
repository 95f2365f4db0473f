// A furnished room, 7.2 m × 6 m, with a table in the middle.
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {

Layout LayOutRoom(SceneBuilder& builder) {
  using Eigen::Vector2d;
  Furnisher furnish(builder, 400);
  const double pi = std::numbers::pi;
  const Vector2d a(-3.6, -3.0), b(3.6, -3.0), c(3.6, 3.0), d(-3.6, 3.0);
  const double height = 2.6;
  AddFloor(furnish, a, c, PaintPlanks, 135);
  AddCeiling(furnish, a, c, height);
  AddWall(furnish, a, b, height, {PaintPlaster, 190});
  AddWall(furnish, b, c, height, {PaintPlaster, 175});
  AddWall(furnish, c, d, height, {PaintPlaster, 180});
  AddWall(furnish, d, a, height, {PaintPlaster, 195});
  builder.AddLamp({-1.6, 0, 2.45});
  builder.AddLamp({1.6, 0, 2.45});

  // A table in the middle, on a rug.
  const int rug = furnish.Picture(PaintRug, 2.6, 1.9, 0.7);
  furnish.Box({}, {-1.3, -0.95, 0}, {2.6, 1.9, 0.008}, {-1, -1, -1, -1, rug, -1});
  furnish.Table({}, 1.4, 0.8, 0.75);
  furnish.Clutter(Place{}.At(0, 0, 0.75), 1.3, 0.7, 9);
  furnish.Chair(Place{}.At(-0.3, 0.55, 0, 0.2));
  furnish.Chair(Place{}.At(0.35, -0.55, 0, pi + 0.3));
  furnish.Chair(Place{}.At(1.0, 0.1, 0, -pi / 2));

  // South wall (y = -3): shelf, cabinet, posters, a door.
  const Place south = AtWall(a, b, 3.6);
  furnish.Shelf(AtWall(a, b, 1.2, 0.16), 1.2, 0.3, 1.95);
  furnish.Cabinet(AtWall(a, b, 2.7, 0.24), 1.2, 0.45, 0.85, 3, 2);
  furnish.Clutter(AtWall(a, b, 2.7, 0.24).At(0, 0, 0.85), 1.1, 0.4, 4);
  furnish.Poster(south, 0.9, 1.65, 0.7, 0.95);
  furnish.Door(south, -1.2, 12);
  furnish.Poster(south, -2.35, 1.6, 0.6, 0.85);
  furnish.Cartons(AtWall(a, b, 6.8, 0.3), 3);

  // East wall: window, desk with a monitor, a whiteboard.
  const Place east = AtWall(b, c, 3.0);
  furnish.Window(east, -1.4);
  const Place desk = AtWall(b, c, 2.0, 0.36);
  furnish.Table(desk, 1.5, 0.7, 0.74);
  furnish.Monitor(desk.At(-0.2, 0.1, 0.74));
  furnish.Box(desk, {-0.4, -0.25, 0.74}, {0.44, 0.15, 0.02},
              {builder.Tone(50), -1, -1, -1, furnish.Picture(PaintKeyboard, 0.44, 0.15), -1});
  furnish.BookPile(desk.At(0.5, 0.1, 0.74), 5);
  furnish.Mug(desk.At(0.3, -0.15, 0.74));
  furnish.Pages(desk.At(0.5, -0.15, 0.741), 2);
  furnish.Chair(desk.At(-0.1, -0.55, 0, pi + 0.4));
  furnish.Hang(east, 0.9, 1.55, 1.3, 0.85, furnish.Picture(PaintBoard, 1.3, 0.85), 0.02);
  furnish.PottedPlant(AtWall(b, c, 5.5, 0.5), 1.4);

  // North wall, with bare bricks behind the sofa: pictures, a lamp.
  const Place north = AtWall(c, d, 3.6);
  furnish.Hang(north, -0.5, 1.3, 1.7, 2.6, furnish.Material(PaintBricks, 1.7, 2.6, 120), 0.01);
  furnish.Sofa(AtWall(c, d, 3.4, 0.48), 1.9);
  furnish.Hang(north, -0.3, 1.7, 0.9, 0.65, furnish.Picture(PaintPoster, 0.9, 0.65), 0.02);
  furnish.Poster(north, 0.95, 1.6, 0.55, 0.75);
  furnish.FloorLamp(AtWall(c, d, 1.9, 0.4));
  furnish.Poster(north, 2.5, 1.55, 0.6, 0.85);
  furnish.Cabinet(AtWall(c, d, 6.0, 0.22), 0.9, 0.4, 1.1, 4, 1);
  furnish.Clutter(AtWall(c, d, 6.0, 0.22).At(0, 0, 1.1), 0.8, 0.35, 3);

  // West wall: shelf, posters, cartons.
  const Place west = AtWall(d, a, 3.0);
  furnish.Shelf(AtWall(d, a, 3.9, 0.16), 1.4, 0.3, 1.6);
  furnish.PottedPlant(AtWall(d, a, 3.9, 0.16).At(-0.3, 0, 1.6), 0.4);
  furnish.Poster(west, 2.0, 1.6, 0.6, 0.8);
  furnish.Poster(west, 1.15, 1.55, 0.7, 0.5);
  furnish.Poster(west, 0.35, 1.65, 0.6, 0.85);
  furnish.Cartons(AtWall(d, a, 1.6, 0.35), 2);
  furnish.PottedPlant(AtWall(d, a, 5.5, 0.45), 1.2);

  // Once around, looking across the room and slightly ahead, alternating left and right.
  std::vector<PathKnot> knots;
  constexpr int kKnots = 48;
  for (int i = 0; i < kKnots; ++i) {
    const double angle = 2 * pi * i / kKnots;
    PathKnot knot;
    knot.position = {2.25 * std::cos(angle), 1.8 * std::sin(angle),
                     1.42 + 0.1 * std::sin(3 * angle)};
    knot.yaw = angle + pi - 0.55 + 0.3 * std::sin(4 * angle);
    knot.pitch = -0.12 + 0.08 * std::sin(5 * angle + 1);
    knots.push_back(knot);
  }
  const std::vector<Walk> walks = {
      {{1.55, 0.95}, {-1.55, 0.95}, {-1.55, -0.95}, {1.55, -0.95}},
      {{1.5, 1.2}, {-1.4, 1.25}, {-1.75, 0.0}, {-1.4, -1.25}, {1.5, -1.2}, {1.75, 0.0}},
  };
  return {knots, 19.0, 1, {}, walks, TableTop{{0, 0, 1.0}, 0.45, 0.2}};
}

}  // namespace alidade
