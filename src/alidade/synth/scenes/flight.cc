// A hall around a given path: furnished walls, and objects on the floor that keep off the path.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Meters.
constexpr double kBelow = 1.5, kAbove = 1.7;  // free height under and over the path
constexpr double kNearWall = 2.0, kFarWall = 3.0;
constexpr double kOffWall = 1.3;  // of objects on the floor
constexpr double kOffPath = 1.0;  // of those as high as the path, in the plan
constexpr double kSpacing = 2.6;  // between objects on the floor

double PlanDistance(const Vector2d& p, const std::vector<Vector3d>& path) {
  double least = 1e9;
  for (const Vector3d& at : path) least = std::min(least, (at.head<2>() - p).norm());
  return least;
}

void AddPillar(Furnisher& furnish, const Place& place, double height) {
  const double side = furnish.random().Uniform(0.4, 0.6);
  BoxFaces faces;
  faces.front = furnish.Material(PaintBricks, side, height, 130);
  faces.back = furnish.Material(PaintBricks, side, height, 110);
  faces.left = furnish.Material(PaintBricks, side, height, 145);
  faces.right = furnish.Material(PaintBricks, side, height, 120);
  furnish.Box(place, {-side / 2, -side / 2, 0}, {side, side, height}, faces);
  furnish.Shade(place, {-side / 2, -side / 2, 0}, {side, side, height});
  for (int i = 0; i < 4; ++i) {
    const double turn = i * std::numbers::pi / 2;
    furnish.Poster(place.At(0, 0, 0, turn).At(0, -side / 2, 0), 0, 1.6, 0.35, 0.5);
  }
}

// Below the lowest point of the path: may stand anywhere.
void AddTable(Furnisher& furnish, const Place& place) {
  const int rug = furnish.Picture(PaintRug, 2.0, 1.5, 0.8);
  furnish.Box(place, {-1.0, -0.75, 0}, {2.0, 1.5, 0.008}, {-1, -1, -1, -1, rug, -1});
  furnish.Table(place, 1.2, 0.7, 0.75);
  furnish.Clutter(place.At(0, 0, 0.75), 1.1, 0.6, 6);
  furnish.Chair(place.At(-0.75, 0, 0, std::numbers::pi / 2));
}

void FillFloor(Furnisher& furnish, const Vector3d& size, const std::vector<Vector3d>& path) {
  Random& random = furnish.random();
  const int columns = std::max(1, static_cast<int>((size.x() - 2 * kOffWall) / kSpacing)),
            rows = std::max(1, static_cast<int>((size.y() - 2 * kOffWall) / kSpacing));
  for (int i = 0; i < columns * rows; ++i) {
    const double x = kOffWall + (size.x() - 2 * kOffWall) * (i % columns + 0.5) / columns,
                 y = kOffWall + (size.y() - 2 * kOffWall) * (i / columns + 0.5) / rows;
    const double dx = random.Uniform(-0.5, 0.5), dy = random.Uniform(-0.5, 0.5),
                 yaw = random.Uniform(-3, 3);
    const Place place = Place{}.At(x + dx, y + dy, 0, yaw);
    const double off = PlanDistance(place.origin.head<2>(), path);
    const uint32_t kind = random.Below(3);
    if (kind == 0 && off > kOffPath + 0.5) {
      AddPillar(furnish, place, size.z());
    } else if (kind == 1) {
      furnish.Cartons(place, 3);
    } else {
      AddTable(furnish, place);
    }
  }
}

// Pictures above the furniture, in rows up to the ceiling.
void HangPictures(Furnisher& furnish, const Vector2d& a, const Vector2d& b, double height) {
  Random& random = furnish.random();
  const double length = (b - a).norm();
  const int count = static_cast<int>((length - 0.6) / 1.9);
  for (double z = 2.85; z + 0.65 < height; z += 1.35) {
    for (int i = 0; i < count; ++i) {
      const double along = 0.3 + (length - 0.6) * (i + 0.5) / count;
      const double shift = random.Uniform(-0.25, 0.25), lift = random.Uniform(-0.12, 0.12);
      const double wide = random.Uniform(0.7, 1.3), high = random.Uniform(0.6, 1.05);
      furnish.Poster(AtWall(a, b, along), shift, z + lift, wide, high);
    }
  }
}

// Beams with lamps between them.
void AddBeams(Furnisher& furnish, const Vector3d& size) {
  const int count = std::max(2, static_cast<int>(size.x() / 2.2));
  for (int i = 0; i < count; ++i) {
    const double x = size.x() * (i + 0.5) / count;
    furnish.WoodBox({}, {x - 0.09, 0, size.z() - 0.25}, {0.18, size.y(), 0.25},
                    furnish.random().Uniform(90, 150));
  }
  const int across = std::max(2, static_cast<int>(size.x() / 4)),
            along = std::max(2, static_cast<int>(size.y() / 4));
  for (int i = 0; i < across * along; ++i)
    furnish.builder().AddLamp({size.x() * (i % across + 0.5) / across,
                               size.y() * (i / across + 0.5) / along, size.z() - 0.3});
}

}  // namespace

Vector3d LayOutFlight(SceneBuilder& builder, std::vector<Vector3d> path) {
  Vector3d low = path.front(), high = path.front();
  for (const Vector3d& at : path) {
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  Random& random = builder.random();
  for (int axis = 0; axis < 2; ++axis) {
    low[axis] -= random.Uniform(kNearWall, kFarWall);
    high[axis] += random.Uniform(kNearWall, kFarWall);
  }
  low.z() -= kBelow;
  high.z() += kAbove;
  const Vector3d size = high - low;
  for (Vector3d& at : path) at -= low;

  // Textures of large halls are coarser: they take as much memory and time to paint.
  Furnisher furnish(builder, std::clamp(4000 / std::sqrt(size.x() * size.y()), 150.0, 360.0));
  const Vector2d a(0, 0), b(size.x(), 0), c(size.x(), size.y()), d(0, size.y());
  AddFloor(furnish, a, c, PaintTiles, 130);
  AddCeiling(furnish, a, c, size.z());
  const WallFinish bricks = {PaintBricks, 135};
  AddWall(furnish, a, b, size.z(), bricks);
  AddWall(furnish, b, c, size.z(), {PaintPlaster, 180});
  AddWall(furnish, c, d, size.z(), bricks);
  AddWall(furnish, d, a, size.z(), {PaintPlaster, 190});
  int kind = static_cast<int>(random.Below(8));
  for (const auto& [from, to] :
       {std::pair(a, b), std::pair(b, c), std::pair(c, d), std::pair(d, a)}) {
    FillWall(furnish, from, to, {}, true, kind);
    HangPictures(furnish, from, to, size.z());
  }
  FillFloor(furnish, size, path);
  AddBeams(furnish, size);
  return low;
}

}  // namespace alidade
