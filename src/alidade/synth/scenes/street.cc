// Streets around a block of houses, driven by a car on the right-hand side, slower at corners.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBlockX = 45, kBlockY = 30;  // meters, half of the block's size
constexpr double kStreet = 13;                // between opposite houses
constexpr double kBack = 1.2;                 // largest setback of a house
constexpr double kLane = 8.1;  // from the block's houses to the middle of the driving lane
constexpr double kCorner = 8;  // radius of the driven path at corners
constexpr double kEye = 1.5;   // meters above the road

// One house with its front from `from` to `to` along a wall, set back by `back` meters.
void AddHouse(Furnisher& furnish, const Place& wall, double from, double to, double back,
              double height) {
  Random& random = furnish.random();
  const double tone = random.Uniform(130, 215);
  const int side = furnish.Material(PaintPlaster, 6, height, tone, 0.5);
  BoxFaces faces = BoxFaces::All(side);
  faces.front = furnish.Material(PaintFacade, to - from, height, tone);
  faces.back = faces.bottom = -1;
  furnish.Box(wall, {from, back, 0}, {to - from, 6, height}, faces);
}

// Houses along the wall from a to b.
void LineWithHouses(Furnisher& furnish, const Vector2d& a, const Vector2d& b) {
  Random& random = furnish.random();
  const double length = (b - a).norm();
  const Place wall = AtWall(a, b, length);
  for (double x = 0; x < length - 0.1;) {
    const double wide = random.Uniform(8, 13), back = random.Uniform(0, kBack);
    const double height = random.Uniform(6, 12);
    const double to = length - x - wide < 5 ? length : x + wide;
    AddHouse(furnish, wall, x, to, back, height);
    x = to;
  }
}

void AddCar(Furnisher& furnish, const Place& place) {
  Random& random = furnish.random();
  const double tone = random.Uniform(40, 215), dark = random.Uniform(25, 60);
  const double length = random.Uniform(3.9, 4.7), cabin = random.Uniform(0.5, 0.62) * length;
  Furnisher& f = furnish;
  const int paint = f.builder().Tone(std::round(tone)), glass = f.builder().Tone(std::round(dark));
  BoxFaces body = BoxFaces::All(paint);
  body.front = body.back = f.Picture(PaintCover, length, 0.75, 0.6);  // doors, lights, trim
  body.left = body.right = f.Picture(PaintCover, 1.7, 0.75, 0.6);
  f.Box(place, {-length / 2, -0.85, 0.25}, {length, 1.7, 0.65}, body);
  BoxFaces roof = BoxFaces::All(glass);
  roof.top = paint;
  f.Box(place, {-cabin / 2 - 0.2, -0.75, 0.9}, {cabin, 1.5, 0.55}, roof);
  const int tyre = f.builder().Tone(35);
  for (const double x : {-0.32 * length, 0.32 * length - 0.6})
    f.Box(place, {x, -0.87, 0}, {0.6, 1.74, 0.55}, BoxFaces::All(tyre));
  f.Shade(place, {-length / 2, -0.85, 0.2}, {length, 1.7, 0.9});
}

// Cars, trees and lamp posts between houses and road, from `from` to `to` meters along a wall.
void AddKerb(Furnisher& furnish, const Vector2d& a, const Vector2d& b, double from, double to) {
  Random& random = furnish.random();
  const Place wall = AtWall(a, b, (b - a).norm());
  for (double x = from; x < to; x += 6) {
    const double kind = random.Uniform(), shift = random.Uniform(0, 0.8);
    if (kind < 0.55) {
      AddCar(furnish, wall.At(x + 2.5 + shift, -3.1, 0));
    } else if (kind < 0.75) {  // a tree
      const double height = random.Uniform(4, 6);
      const Place tree = wall.At(x + 2, -1.9, 0);
      const int bark = furnish.Material(PaintCarpet, 0.8, 2.5, 80);
      furnish.Round(tree, 0, 0, 0, height * 0.6, 0.16, 0.1, bark);
      for (int i = 0; i < 6; ++i) {
        const double turn = random.Uniform(0, 6.28), off = random.Uniform(0.2, 1.0);
        const double up = random.Uniform(0.5, 1.0), r = random.Uniform(0.5, 0.9);
        furnish.Ball(tree, off * std::cos(turn), off * std::sin(turn), height * up, {r, r, 0.8 * r},
                     furnish.Picture(PaintLeaves, 6 * r, 3 * r, 0.5));
      }
    } else {  // a lamp post with a sign
      const Place post = wall.At(x + 1, -1.7, 0);
      furnish.Round(post, 0, 0, 0, 4.5, 0.07, 0.05, furnish.builder().Tone(70));
      const int sign = furnish.Picture(PaintPoster, 0.6, 0.8, 1.5);
      furnish.Box(post, {-0.3, -0.09, 2.0}, {0.6, 0.02, 0.8}, {sign, sign, -1, -1, -1, -1});
      furnish.Box(post, {-0.09, -0.35, 2.0}, {0.02, 0.7, 0.7}, {-1, -1, sign, sign, -1, -1});
    }
  }
}

void AddRoad(Furnisher& furnish) {
  // Covers the setback of the houses, too.
  constexpr double kX = kBlockX + kStreet + kBack, kY = kBlockY + kStreet + kBack;
  constexpr double kPiece = 6.5;  // meters; four kinds of pieces
  int kinds[4];
  for (int& kind : kinds) {
    const double tone = furnish.random().Uniform(140, 165);
    kind = furnish.Material(PaintAsphalt, kPiece, kPiece, tone);
  }
  for (int j = 0; j * kPiece < 2 * kY; ++j) {
    for (int i = 0; i * kPiece < 2 * kX; ++i) {
      const double x = -kX + i * kPiece, y = -kY + j * kPiece;
      if (x > -kBlockX + kBack && x + kPiece < kBlockX - kBack && y > -kBlockY + kBack &&
          y + kPiece < kBlockY - kBack)
        continue;
      const auto kind = static_cast<size_t>(furnish.random().Below(4));
      furnish.Box({}, {x, y, -0.1}, {kPiece, kPiece, 0.1}, {-1, -1, -1, -1, kinds[kind], -1});
    }
  }
  // Dashed center line.
  const BoxFaces paint = {-1, -1, -1, -1, furnish.builder().Tone(225), -1};
  const double my = kBlockY + kStreet / 2, mx = kBlockX + kStreet / 2;
  for (double x = -kBlockX; x < kBlockX; x += 6) {
    for (const double y : {-my, my}) furnish.Box({}, {x, y - 0.07, 0}, {3, 0.14, 0.005}, paint);
  }
  for (double y = -kBlockY; y < kBlockY; y += 6) {
    for (const double x : {-mx, mx}) furnish.Box({}, {x - 0.07, y, 0}, {0.14, 3, 0.005}, paint);
  }
}

// Position and direction `s` meters along the path (counter-clockwise from the middle of the south
// side), and the distance to the nearest corner.
struct Spot {
  Vector2d p;
  double yaw = 0, to_corner = 0;
};
struct Way {
  double x = kBlockX + kLane - kCorner, y = kBlockY + kLane - kCorner;  // half straights
  double arc = kCorner * std::numbers::pi / 2;
  double Length() const { return 4 * (x + y + arc); }
  Spot At(double s) const {
    // Each of four sides: half a straight, the corner, half of the next straight.
    s -= std::floor(s / Length()) * Length();
    int side = 0;
    double here = x, next = y;
    while (s > here + arc + next) {
      s -= here + arc + next;
      std::swap(here, next);
      ++side;
    }
    Spot spot;
    Vector2d p;
    const double depth = (side % 2 == 0 ? y : x) + kCorner;  // from the center of the block
    if (s < here) {
      p = {s, -depth};
      spot.to_corner = here - s;
    } else if (s < here + arc) {
      const double turn = (s - here) / kCorner;
      p = {here + kCorner * std::sin(turn), -depth + kCorner * (1 - std::cos(turn))};
      spot.yaw = turn;
    } else {
      p = {here + kCorner, -depth + kCorner + (s - here - arc)};
      spot.yaw = std::numbers::pi / 2;
      spot.to_corner = s - here - arc;
    }
    for (int i = 0; i < side; ++i) p = Vector2d(-p.y(), p.x());
    spot.p = p;
    spot.yaw += side * std::numbers::pi / 2;
    return spot;
  }
};

// Speed profile of a car: 10 m/s, 5 m/s at corners, acceleration ±2.5 m/s². Knots at equal times.
std::vector<PathKnot> Drive(double& period) {
  constexpr double kKnot = 0.25, kStep = 0.01;  // seconds, meters
  const Way way;
  std::vector<double> until = {0};  // seconds at each step
  for (double s = 0; s < way.Length(); s += kStep) {
    const double speed = std::min(10.0, std::sqrt(5.0 * 5.0 + 2 * 2.5 * way.At(s).to_corner));
    until.push_back(until.back() + kStep / speed);
  }
  const int count = static_cast<int>(until.back() / kKnot);
  period = count * kKnot;
  std::vector<PathKnot> knots;
  size_t step = 0;
  for (int i = 0; i < count; ++i) {
    while (until[step + 1] < until.back() * i / count) ++step;
    const Spot spot = way.At(static_cast<double>(step) * kStep);
    knots.push_back({{spot.p.x(), spot.p.y(), kEye}, spot.yaw, -0.02});
  }
  return knots;
}

}  // namespace

Layout LayOutStreet(SceneBuilder& builder) {
  Furnisher furnish(builder, 45);
  AddRoad(furnish);
  const double x = kBlockX, y = kBlockY, ox = x + kStreet, oy = y + kStreet;
  const Vector2d outer[4] = {{-ox, -oy}, {ox, -oy}, {ox, oy}, {-ox, oy}};
  // The street is to the left of each side.
  const Vector2d inner[4] = {{-x, -y}, {-x, y}, {x, y}, {x, -y}};
  for (int i = 0; i < 4; ++i) {
    const Vector2d &a = outer[i], &b = outer[(i + 1) % 4], &c = inner[i], &d = inner[(i + 1) % 4];
    LineWithHouses(furnish, a, b);
    LineWithHouses(furnish, c, d);
    AddKerb(furnish, a, b, kStreet + 2, (b - a).norm() - kStreet - 7);
    AddKerb(furnish, c, d, 2, (d - c).norm() - 7);
  }
  ShakeSettings shake;
  shake.position = 0.012;
  shake.rotation = 0.004;
  shake.seconds = 0.4;
  // People stay on the sidewalk in front of the southern houses.
  const std::vector<Walk> walks = {
      {{-20, -oy + 0.8}, {25, -oy + 0.8}, {25, -oy + 1.4}, {-20, -oy + 1.4}}};
  Layout layout;
  layout.knots = Drive(layout.period);
  layout.turns = 1;
  layout.shake = shake;
  layout.walks = walks;
  return layout;
}

}  // namespace alidade
