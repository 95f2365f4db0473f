// Six rooms in two rows, connected by doorways to a loop.
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {
namespace {

using Eigen::Vector2d;

constexpr double kPitchX = 7.2, kPitchY = 7.0;  // meters between the centers of adjacent rooms
constexpr double kHalfWall = 0.07;              // half of the wall's thickness
constexpr double kDoorway = 1.3;                // width
constexpr double kHeight = 2.7;

struct RoomLook {
  Furnisher::ToneFn floor;
  double floor_tone;
  WallFinish walls;
};

void AddRoom(Furnisher& furnish, int i, int j, const RoomLook& look, bool bricks) {
  const Vector2d middle(kPitchX * i, kPitchY * j);
  const double hx = kPitchX / 2 - kHalfWall, hy = kPitchY / 2 - kHalfWall;
  const Vector2d a = middle + Vector2d(-hx, -hy), b = middle + Vector2d(hx, -hy),
                 c = middle + Vector2d(hx, hy), d = middle + Vector2d(-hx, hy);
  AddFloor(furnish, a, c, look.floor, look.floor_tone);
  AddCeiling(furnish, a, c, kHeight);
  furnish.builder().AddLamp({middle.x() - 1.5, middle.y(), kHeight - 0.2});
  furnish.builder().AddLamp({middle.x() + 1.5, middle.y(), kHeight - 0.2});
  // Doorways: along both rows, and between the rows at either end.
  const std::vector<Opening> none, across = {{hy - kDoorway / 2, hy + kDoorway / 2}},
                                   between = {{hx - kDoorway / 2, hx + kDoorway / 2}};
  const bool end = i != 1;
  const std::vector<Opening> south = j == 1 && end ? between : none,
                             north = j == 0 && end ? between : none;
  const std::vector<Opening> east = i < 2 ? across : none, west = i > 0 ? across : none;
  const WallFinish brick = {PaintBricks, 125};
  AddWall(furnish, a, b, kHeight, bricks && j == 0 ? brick : look.walls, south);
  AddWall(furnish, b, c, kHeight, look.walls, east);
  AddWall(furnish, c, d, kHeight, bricks && j == 1 ? brick : look.walls, north);
  AddWall(furnish, d, a, kHeight, look.walls, west);
  int kind = static_cast<int>(furnish.random().Below(8));
  FillWall(furnish, a, b, south, j == 0, kind);
  FillWall(furnish, b, c, east, i == 2, kind);
  FillWall(furnish, c, d, north, j == 1, kind);
  FillWall(furnish, d, a, west, i == 0, kind);
}

}  // namespace

Layout LayOutLoop(SceneBuilder& builder) {
  Furnisher furnish(builder, 320);
  const RoomLook looks[6] = {
      {PaintPlanks, 135, {PaintPlaster, 190}}, {PaintCarpet, 110, {PaintPlaster, 165}},
      {PaintTiles, 140, {PaintPlaster, 195}},  {PaintTiles, 110, {PaintPlaster, 180}},
      {PaintPlanks, 105, {PaintPlaster, 200}}, {PaintCarpet, 135, {PaintPlaster, 175}}};
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 3; ++i) AddRoom(furnish, i, j, looks[3 * j + i], (i + j) % 2 == 1);
  }
  // Free-standing tables beside the path.
  constexpr double kTables[6][2] = {{-0.9, 1.1}, {7.2, -1.3}, {15.2, 1.1},
                                    {15.3, 5.9}, {7.2, 8.4},  {-0.9, 5.9}};
  for (const auto& at : kTables) {
    const Place table = Place{}.At(at[0], at[1], 0, furnish.random().Uniform(-0.2, 0.2));
    const int rug = furnish.Picture(PaintRug, 2.0, 1.5, 0.8);
    furnish.Box(table, {-1.0, -0.75, 0}, {2.0, 1.5, 0.008}, {-1, -1, -1, -1, rug, -1});
    furnish.Table(table, 1.2, 0.7, 0.75);
    furnish.Clutter(table.At(0, 0, 0.75), 1.1, 0.6, 6);
    furnish.Chair(table.At(-0.75, 0, 0, std::numbers::pi / 2));
    furnish.Chair(table.At(0.75, 0.05, 0, -std::numbers::pi / 2));
  }

  const std::vector<Vector2d> way = {
      {0.5, -0.9},  {3.6, 0},    {5.4, 0.35}, {9.0, 0.35}, {10.8, 0},   {13.9, -0.9},
      {15.4, -0.6}, {15.6, 0.9}, {14.4, 3.5}, {15.6, 6.1}, {15.4, 7.6}, {13.9, 7.9},
      {10.8, 7.0},  {9.0, 6.65}, {5.4, 6.65}, {3.6, 7.0},  {0.5, 7.9},  {-1.0, 7.6},
      {-1.2, 6.1},  {0, 3.5},    {-1.2, 0.9}, {-1.0, -0.6}};
  constexpr int kKnots = 128;  // 0.5 s apart
  std::vector<PathKnot> knots = KnotsAlong(way, 1.45, kKnots);
  for (int i = 0; i < kKnots; ++i) {
    const double angle = 2 * std::numbers::pi * i / kKnots;
    knots[i].yaw += 0.38 * std::sin(13 * angle);
    knots[i].pitch = -0.13 + 0.07 * std::sin(9 * angle);
    knots[i].position.z() += 0.06 * std::sin(7 * angle);
  }
  std::vector<Walk> walks;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 3; ++i) {
      const Vector2d m(kPitchX * i, kPitchY * j);
      walks.push_back({m + Vector2d(-2, -2), m + Vector2d(2, -2), m + Vector2d(2.2, 0.5),
                       m + Vector2d(0, 2), m + Vector2d(-2, 2)});
    }
  }
  return {knots, 64.0, 1, {}, walks, {}};
}

}  // namespace alidade
