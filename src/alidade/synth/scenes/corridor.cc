// A corridor of 15 m with repeating doors and posters: places look alike.
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {
namespace {

constexpr double kHalf = 7.5;  // meters, half of the length
constexpr double kSide = 1.3;  // half of the width

// Out on one side, a small arc, and back; knots at equal times.
std::vector<PathKnot> OutAndBack() {
  constexpr double kReach = 5.0, kLane = 0.22;  // meters
  constexpr int kStraight = 29, kTurn = 5;      // knots, 0.5 s apart
  constexpr int kAll = 2 * (kStraight + kTurn);
  const double pi = std::numbers::pi;
  std::vector<PathKnot> knots;
  for (int i = 0; i < kAll; ++i) {
    const int half = i / (kStraight + kTurn), step = i % (kStraight + kTurn);
    double x, y, yaw;
    if (step < kStraight) {
      x = -kReach + 2 * kReach * step / (kStraight - 1);
      y = -kLane;
      yaw = 0;
    } else {
      const double share = (step - kStraight + 1.0) / (kTurn + 1);
      x = kReach + 0.35 * std::sin(pi * share);
      y = -kLane * std::cos(pi * share);
      yaw = pi * share;
    }
    PathKnot knot;
    const double sign = half == 0 ? 1 : -1;
    knot.position = {sign * x, sign * y, 1.45};
    // Looks alternately at both walls; straight ahead before a turn.
    const double calm = step < kStraight ? std::sin(pi * step / (kStraight - 1.0)) : 0;
    knot.yaw = half * pi + yaw + 0.42 * std::sqrt(calm) * std::sin(2 * pi * i / 9.0 + 0.8);
    knot.pitch = -0.1 + 0.06 * std::sin(2 * pi * 9 * i / kAll) - (step < kStraight ? 0 : 0.15);
    knots.push_back(knot);
  }
  return knots;
}

}  // namespace

Layout LayOutCorridor(SceneBuilder& builder) {
  using Eigen::Vector2d;
  Furnisher furnish(builder, 400);
  const double height = 2.5;
  const Vector2d a(-kHalf, -kSide), b(kHalf, -kSide), c(kHalf, kSide), d(-kHalf, kSide);
  AddFloor(furnish, a, c, PaintTiles, 130);
  AddCeiling(furnish, a, c, height);
  AddWall(furnish, a, b, height, {PaintPlaster, 188});
  AddWall(furnish, b, c, height, {PaintPlaster, 180});
  AddWall(furnish, c, d, height, {PaintPlaster, 188});
  AddWall(furnish, d, a, height, {PaintPlaster, 180});
  for (double x = -6; x <= 6; x += 3) builder.AddLamp({x, 0, 2.4});

  // The same door and the same three posters repeat.
  const int door = builder.Paint([](Random& random) { return PaintDoor(random, {380, 832}, 7); });
  const int posters[3] = {furnish.Picture(PaintPoster, 0.6, 0.85),
                          furnish.Picture(PaintPoster, 0.8, 0.6),
                          furnish.Picture(PaintPoster, 0.5, 0.7)};
  const int lamp = builder.Tone(250), sign = furnish.Picture(PaintCover, 0.25, 0.12, 2);
  for (int side = 0; side < 2; ++side) {
    const Place wall = side == 0 ? AtWall(a, b, kHalf) : AtWall(c, d, kHalf);
    for (int i = -2; i <= 1; ++i) {
      const double x = 3.0 * i + 0.6 * side;
      furnish.Hang(wall, x, 1.04, 0.95, 2.08, door, 0.03);
      furnish.Hang(wall, x + 0.72, 1.65, 0.25, 0.12, sign, 0.004);
      furnish.Hang(wall, x + 1.5, 1.55, i % 2 == 0 ? 0.6 : 0.8, i % 2 == 0 ? 0.85 : 0.6,
                   posters[i % 2 == 0 ? 0 : 1], 0.008);
      furnish.Hang(wall, x + 1.5, 0.35, 0.09, 0.09, builder.Tone(225), 0.012);
    }
  }
  for (double x = -6; x <= 6; x += 3)
    furnish.Box(Place{}.At(x, 0, height - 0.06), {-0.6, -0.12, 0}, {1.2, 0.24, 0.06},
                BoxFaces::All(lamp));
  // The ends, and the few objects that distinguish places.
  furnish.Window(AtWall(b, c, kSide), 0);
  furnish.Hang(AtWall(d, a, kSide), -0.3, 1.04, 0.95, 2.08, door, 0.03);
  furnish.Hang(AtWall(d, a, kSide), 0.65, 1.5, 0.5, 0.7, posters[2], 0.008);
  // Where the camera turns around.
  for (const Place& wall : {AtWall(a, b, kHalf), AtWall(c, d, kHalf)}) {
    furnish.Shelf(wall.At(6.2, -0.17, 0), 1.3, 0.3, 1.95);
    furnish.Hang(wall, 4.9, 1.5, 0.9, 0.7, furnish.Picture(PaintBoard, 0.9, 0.7), 0.015);
  }
  furnish.PottedPlant(AtWall(a, b, 14.3, 0.4), 1.1);
  furnish.Cartons(AtWall(a, b, 13.0, 0.25), 2);
  furnish.Cartons(AtWall(c, d, 13.9, 0.28), 3);

  const std::vector<Walk> walks = {{{-5.5, -0.95}, {5.5, -0.95}, {5.5, 0.95}, {-5.5, 0.95}}};
  return {OutAndBack(), 33.0, 1, {}, walks, {}};
}

}  // namespace alidade
