// Furniture along a wall.
#include <algorithm>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"

namespace alidade {

using Eigen::Vector2d;

namespace {

// One object against a wall, with its middle `along` meters from a, in a slot of width `width`.
void FillSlot(Furnisher& furnish, const Vector2d& a, const Vector2d& b, double along, double width,
              bool outside, int kind) {
  const Place wall = AtWall(a, b, along);
  Random& random = furnish.random();
  switch (kind) {
    case 0:
      furnish.Shelf(AtWall(a, b, along, 0.17), std::min(1.3, width - 0.15), 0.3,
                    random.Uniform(1.4, 2.0));
      break;
    case 1: {
      const double w = std::min(1.2, width - 0.2), h = random.Uniform(0.7, 1.1);
      const Place here = AtWall(a, b, along, 0.24);
      const int columns = 1 + static_cast<int>(random.Below(2)),
                rows = 2 + static_cast<int>(random.Below(3));
      furnish.Cabinet(here, w, 0.45, h, rows, columns);
      furnish.Clutter(here.At(0, 0, h), w - 0.1, 0.4, 3);
      const double high = random.Uniform(0.5, 0.8), wide = random.Uniform(0.5, 0.9);
      furnish.Poster(wall, 0.1, 1.75, wide, high);
      break;
    }
    case 2:
      if (width > 1.7) {
        furnish.Sofa(AtWall(a, b, along, 0.48), std::min(1.9, width - 0.1));
        const double high = random.Uniform(0.5, 0.7), wide = random.Uniform(0.7, 1.0);
        furnish.Poster(wall, -0.3, 1.65, wide, high);
        break;
      }
      [[fallthrough]];
    case 3: {
      const double w = std::min(1.4, width - 0.1);
      const Place desk = AtWall(a, b, along, 0.36);
      furnish.Table(desk, w, 0.7, 0.74);
      furnish.Monitor(desk.At(-0.15, 0.1, 0.74));
      furnish.BookPile(desk.At(w / 2 - 0.2, 0.1, 0.74), 4);
      furnish.Mug(desk.At(-w / 2 + 0.15, -0.1, 0.74));
      furnish.Chair(desk.At(0.1, -0.5, 0, std::numbers::pi + random.Uniform(-0.5, 0.5)));
      furnish.Poster(wall, 0.35, 1.7, 0.6, 0.6);
      break;
    }
    case 4:
      if (outside && width > 1.6) {
        furnish.Window(wall, 0);
        break;
      }
      [[fallthrough]];
    case 5:
      furnish.Hang(wall, 0, 1.5, std::min(1.3, width - 0.2), 0.9,
                   furnish.Picture(PaintBoard, std::min(1.3, width - 0.2), 0.9), 0.02);
      furnish.Cartons(AtWall(a, b, along, 0.28), 1 + static_cast<int>(random.Below(2)));
      break;
    case 6:
      furnish.PottedPlant(AtWall(a, b, along + 0.35, 0.4), random.Uniform(1.0, 1.5));
      furnish.Poster(wall, 0.2, 1.55, 0.65, 0.9);
      break;
    default:
      furnish.Poster(wall, -0.35, 1.5, 0.55, 0.75);
      furnish.Poster(wall, 0.4, 1.65, 0.6, 0.5);
      furnish.Cartons(AtWall(a, b, along - 0.2, 0.3), 2);
  }
}

}  // namespace

void FillWall(Furnisher& furnish, const Vector2d& a, const Vector2d& b,
              const std::vector<Opening>& openings, bool outside, int& kind) {
  double from = 0.75;
  std::vector<Opening> free;
  for (const Opening& opening : openings) {
    free.push_back({from, opening.from - 0.2});
    from = opening.to + 0.2;
  }
  free.push_back({from, (b - a).norm() - 0.75});
  for (const Opening& span : free) {
    const double length = span.to - span.from;
    const int slots = static_cast<int>(length / 1.55);
    for (int i = 0; i < slots; ++i) {
      FillSlot(furnish, a, b, span.from + length * (i + 0.5) / slots, length / slots, outside,
               kind % 8);
      kind += 3;  // cycles through all eight kinds
    }
  }
}

}  // namespace alidade
