// Scenes with almost blank walls: a rotation in a room ("blank"), and a walk along a hall ("hall").
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {

using Eigen::Vector2d;

// The north wall is blank except for a switch, a socket and a small picture.
Layout LayOutBlank(SceneBuilder& builder) {
  Furnisher furnish(builder, 400);
  const double pi = std::numbers::pi, height = 2.6;
  const Vector2d a(-3.0, -2.6), b(3.0, -2.6), c(3.0, 2.6), d(-3.0, 2.6);
  AddFloor(furnish, a, c, PaintPlanks, 130);
  AddCeiling(furnish, a, c, height);
  AddWall(furnish, a, b, height, {PaintPlaster, 185});
  AddWall(furnish, b, c, height, {PaintPlaster, 178});
  AddWall(furnish, c, d, height, {PaintPlaster, 195});
  AddWall(furnish, d, a, height, {PaintPlaster, 185});
  builder.AddLamp({-1.2, 0, 2.4});
  builder.AddLamp({1.2, 0, 2.4});

  const Place north = AtWall(c, d, 3.0);
  furnish.Hang(north, 0.35, 1.7, 0.3, 0.22, furnish.Picture(PaintPoster, 0.3, 0.22, 1.5), 0.01);
  furnish.Hang(north, -1.3, 1.1, 0.09, 0.09, furnish.Picture(PaintCover, 0.09, 0.09, 2), 0.012);
  furnish.Hang(north, 1.5, 0.35, 0.09, 0.09, furnish.Picture(PaintCover, 0.09, 0.09, 2), 0.012);

  furnish.Shelf(AtWall(a, b, 1.2, 0.16), 1.2, 0.3, 1.95);
  furnish.Cabinet(AtWall(a, b, 2.8, 0.24), 1.2, 0.45, 0.85, 3, 2);
  furnish.Clutter(AtWall(a, b, 2.8, 0.24).At(0, 0, 0.85), 1.1, 0.4, 5);
  furnish.Poster(AtWall(a, b, 2.8), 0, 1.6, 0.7, 0.95);
  furnish.Door(AtWall(a, b, 4.2), 0, 3);
  furnish.Poster(AtWall(a, b, 5.3), 0, 1.5, 0.6, 0.8);
  furnish.Window(AtWall(b, c, 1.4), 0);
  const Place desk = AtWall(b, c, 3.2, 0.36);
  furnish.Table(desk, 1.4, 0.7, 0.74);
  furnish.Monitor(desk.At(-0.2, 0.1, 0.74));
  furnish.Clutter(desk.At(0.35, 0, 0.74), 0.6, 0.6, 4);
  furnish.Poster(AtWall(b, c, 3.6), 0, 1.7, 0.7, 0.5);
  furnish.Sofa(AtWall(d, a, 3.4, 0.48), 1.8);
  furnish.Poster(AtWall(d, a, 3.1), 0, 1.6, 0.9, 0.65);
  furnish.Shelf(AtWall(d, a, 1.4, 0.16), 1.0, 0.3, 1.6);

  // A small circle in the middle of the room during one full turn, looking outwards.
  std::vector<PathKnot> knots;
  constexpr int kKnots = 48;
  for (int i = 0; i < kKnots; ++i) {
    const double angle = 2 * pi * i / kKnots;
    PathKnot knot;
    knot.position = {0.75 * std::cos(angle + 0.4), 0.55 * std::sin(angle + 0.4),
                     1.45 + 0.08 * std::sin(3 * angle)};
    knot.yaw = angle - pi / 2 + 0.2 * std::sin(2 * angle);
    knot.pitch = -0.1 + 0.06 * std::sin(4 * angle);
    knots.push_back(knot);
  }
  const std::vector<Walk> walks = {{{-1.6, -1.2}, {1.6, -1.2}, {1.6, 1.2}, {-1.6, 1.2}}};
  return {knots, 14.0, 1, {}, walks, {}};
}

// The north wall is blank over 6 m except for a socket every 2 m; the rest is furnished.
Layout LayOutHall(SceneBuilder& builder) {
  Furnisher furnish(builder, 400);
  const double pi = std::numbers::pi, height = 2.6, half = 5.5, side = 1.6;
  const Vector2d a(-half, -side), b(half, -side), c(half, side), d(-half, side);
  AddFloor(furnish, a, c, PaintTiles, 130);
  AddCeiling(furnish, a, c, height);
  AddWall(furnish, a, b, height, {PaintPlaster, 185});
  AddWall(furnish, b, c, height, {PaintPlaster, 178});
  AddWall(furnish, c, d, height, {PaintPlaster, 195});
  AddWall(furnish, d, a, height, {PaintPlaster, 185});
  for (const double x : {-3.5, 0.0, 3.5}) builder.AddLamp({x, 0, 2.4});

  const Place north = AtWall(c, d, half);
  for (const double x : {-2.0, 0.0, 2.0})
    furnish.Hang(north, x, 0.9, 0.09, 0.09, furnish.Picture(PaintCover, 0.09, 0.09, 2), 0.012);
  for (const double x : {-4.6, -3.7, 3.7, 4.6}) furnish.Poster(north, x, 1.5, 0.6, 0.8);
  furnish.Door(AtWall(d, a, side), 0.4, 1);
  furnish.Poster(AtWall(d, a, side), -0.7, 1.5, 0.6, 0.8);
  furnish.Window(AtWall(b, c, side), 0);
  const Place south = AtWall(a, b, half);
  for (int i = 0; i < 6; ++i) {
    const double x = -4.4 + 1.75 * i;
    if (i % 3 == 0) {
      furnish.Shelf(south.At(x, -0.17, 0), 1.1, 0.3, 1.9);
    } else if (i % 3 == 1) {
      furnish.Poster(south, x, 1.55, 0.7, 0.95);
      furnish.Cartons(south.At(x, -0.25, 0), 2);
    } else {
      furnish.Cabinet(south.At(x, -0.24, 0), 1.0, 0.45, 0.9, 3, 2);
      furnish.Poster(south, x, 1.6, 0.6, 0.5);
    }
  }

  // East along the blank wall at a distance of 1.5 m, looking at it obliquely; turn; back, looking
  // at the other wall. Knots are 0.5 s apart.
  constexpr int kStraight = 22, kTurn = 6, kAll = 2 * (kStraight + kTurn);
  std::vector<PathKnot> knots;
  for (int i = 0; i < kAll; ++i) {
    const int leg = i / (kStraight + kTurn), step = i % (kStraight + kTurn);
    PathKnot knot;
    double x = 0, y = 0, along = 0;
    if (step < kStraight) {
      x = -3.6 + 7.2 * step / (kStraight - 1);
      y = 0.1;
      // Oblique by 50 degrees in the middle, straight ahead at the ends.
      along = 0.88 * std::sqrt(std::sin(pi * step / (kStraight - 1.0)));
    } else {
      const double share = (step - kStraight + 1.0) / (kTurn + 1);
      x = 3.6 + 0.3 * std::sin(pi * share);
      y = 0.1 * std::cos(pi * share);
      along = -pi * share;  // clockwise, through south
    }
    const double sign = leg == 0 ? 1 : -1;
    knot.position = {sign * x, sign * y, 1.45 + 0.05 * std::sin(2 * pi * 7 * i / kAll)};
    knot.yaw = -leg * pi + along;
    knot.pitch = -0.08 + 0.05 * std::sin(2 * pi * 9 * i / kAll);
    knots.push_back(knot);
  }
  const std::vector<Walk> walks = {{{-3.5, -0.9}, {3.5, -0.9}, {3.5, -0.6}, {-3.5, -0.6}}};
  return {knots, 28.0, -1, {}, walks, {}};
}

}  // namespace alidade
