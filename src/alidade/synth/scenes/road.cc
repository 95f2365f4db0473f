// A country road driven at 14 m/s: fields with little texture, posts, a few trees; most texture is
// far away.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalfStraight = 120;  // meters, half of each of the two straights
constexpr double kBend = 71.7;         // radius of the two bends to the middle of the driving lane
constexpr double kMiddle = 1.7;        // from there to the middle of the road, to the left
constexpr double kRoadSpeed = 14;      // meters per second

constexpr double RoadLength() { return 4 * kHalfStraight + 2 * std::numbers::pi * kBend; }

// Place `s` meters along the driving lane: x ahead, y to the left.
Place Along(double s) {
  const double pi = std::numbers::pi, bend = pi * kBend;
  s -= std::floor(s / RoadLength()) * RoadLength();
  const bool back = s >= 2 * kHalfStraight + bend;
  if (back) s -= 2 * kHalfStraight + bend;
  Vector2d p(-kHalfStraight + std::min(s, 2 * kHalfStraight), -kBend);
  double yaw = 0;
  if (s > 2 * kHalfStraight) {
    yaw = (s - 2 * kHalfStraight) / kBend;
    p = {kHalfStraight + kBend * std::sin(yaw), -kBend * std::cos(yaw)};
  }
  if (back) {
    p = -p;
    yaw += pi;
  }
  return {{p.x(), p.y(), 0}, yaw};
}

void AddGround(Furnisher& furnish) {
  constexpr double kPiece = 40;
  int fields[3];
  for (int& field : fields) {
    const double tone = furnish.random().Uniform(135, 165);
    field = furnish.Material(PaintPlaster, kPiece, kPiece, tone, 0.25);
  }
  for (double y = -320; y < 320; y += kPiece) {
    for (double x = -400; x < 400; x += kPiece) {
      const auto field = static_cast<size_t>(furnish.random().Below(3));
      furnish.Box({}, {x, y, -0.1}, {kPiece, kPiece, 0.1}, {-1, -1, -1, -1, fields[field], -1});
    }
  }
}

void AddSurface(Furnisher& furnish) {
  constexpr double kPiece = 8;
  int kinds[4];
  for (int& kind : kinds) kind = furnish.Material(PaintAsphalt, kPiece + 0.8, 7, 150);
  const int white = furnish.builder().Tone(235);
  for (int i = 0; i * kPiece < RoadLength(); ++i) {
    const Place here = Along(i * kPiece).At(0, kMiddle, 0);
    const double height = i % 2 == 0 ? 0.01 : 0.015;  // pieces overlap in bends
    const auto kind = static_cast<size_t>(furnish.random().Below(4));
    furnish.Box(here, {-0.4, -3.5, 0}, {kPiece + 0.8, 7, height},
                {-1, -1, -1, -1, kinds[kind], -1});
    furnish.Box(here, {0, -0.06, 0.015}, {3, 0.12, 0.005}, {-1, -1, -1, -1, white, -1});
  }
}

void AddTree(Furnisher& furnish, const Place& place, const int (&leaves)[5], int bark) {
  Random& random = furnish.random();
  const double height = random.Uniform(5, 10);
  furnish.Round(place, 0, 0, 0, 0.6 * height, 0.2, 0.12, bark);
  for (int i = 0; i < 4; ++i) {
    const double turn = random.Uniform(0, 6.28), off = random.Uniform(0.2, 1.4);
    const double up = random.Uniform(0.5, 1.0), r = random.Uniform(0.8, 1.5);
    const auto kind = static_cast<size_t>(random.Below(5));
    furnish.Ball(place, off * std::cos(turn), off * std::sin(turn), height * up, {r, r, 0.9 * r},
                 leaves[kind]);
  }
}

void AddRoadside(Furnisher& furnish) {
  Random& random = furnish.random();
  int leaves[5];
  for (int& leaf : leaves) leaf = furnish.Picture(PaintLeaves, 6, 3, 1.2);
  const int bark = furnish.Material(PaintCarpet, 1, 4, 80);
  const int white = furnish.builder().Tone(240), dark = furnish.builder().Tone(50);
  for (double s = 0; s < RoadLength(); s += 24) {
    for (const double y : {-2.6, 6.0}) {
      const Place post = Along(s).At(0, y, 0);
      furnish.Box(post, {-0.06, -0.06, 0}, {0.12, 0.12, 0.95}, BoxFaces::All(white));
      furnish.Box(post, {-0.065, -0.065, 0.6}, {0.13, 0.13, 0.2}, BoxFaces::All(dark));
    }
    for (const double side : {-1.0, 1.0}) {
      const double kind = random.Uniform();
      const double on = random.Uniform(0, 20), off = random.Uniform(8, 26);
      if (kind < 0.6) {
        AddTree(furnish, Along(s + on).At(0, kMiddle + side * off, 0), leaves, bark);
      } else if (kind < 0.7) {
        const Place house = Along(s + on).At(0, kMiddle + side * (off + 10), 0);
        BoxFaces faces = BoxFaces::All(furnish.Material(PaintFacade, 10, 6, 180));
        faces.bottom = -1;
        furnish.Box(house, {-5, -4, 0}, {10, 8, 6}, faces);
      } else if (kind < 0.85 && side < 0) {
        const Place sign = Along(s + on).At(0, -3.4, 0, -std::numbers::pi / 2);
        furnish.Round(sign, 0, 0, 0, 2.0, 0.04, 0.04, dark);
        furnish.Hang(sign, 0, 2.2, 0.8, 0.9, furnish.Picture(PaintPoster, 0.8, 0.9, 2), 0.02);
      }
    }
  }
  // Woods around the fields.
  for (int i = 0; i < 48; ++i) {
    const double angle = 2 * std::numbers::pi * i / 48, height = random.Uniform(9, 17);
    const Place edge =
        Place{}.At(300 * std::cos(angle), 230 * std::sin(angle), 0, angle - std::numbers::pi / 2);
    const int wood = furnish.Picture(PaintLeaves, 42, height, 0.12);
    furnish.Box(edge, {-21, 0, 0}, {42, 1, height}, {wood, -1, -1, -1, -1, -1});
  }
}

}  // namespace

Layout LayOutRoad(SceneBuilder& builder) {
  Furnisher furnish(builder, 30);
  AddGround(furnish);
  AddSurface(furnish);
  AddRoadside(furnish);
  Layout layout;
  // Knots, 0.25 s apart.
  const int count = static_cast<int>(RoadLength() / (kRoadSpeed / 4));
  for (int i = 0; i < count; ++i) {
    const Place here = Along(RoadLength() * i / count);
    layout.knots.push_back({here.origin + Vector3d(0, 0, 1.5), here.yaw, -0.02});
  }
  layout.period = count / 4.0;
  layout.turns = 1;
  layout.shake.position = 0.012;
  layout.shake.rotation = 0.004;
  layout.shake.seconds = 0.4;
  layout.walks = {{{-60, -kBend - 4}, {60, -kBend - 4}, {60, -kBend - 5}, {-60, -kBend - 5}}};
  return layout;
}

}  // namespace alidade
