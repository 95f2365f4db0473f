#include "alidade/synth/scenes/furniture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace alidade {

using Eigen::Vector3d;

void Furnisher::Table(const Place& place, double width, double depth, double height) {
  const double tone = random().Uniform(120, 190);
  const double x = -width / 2, y = -depth / 2, leg = 0.06;
  WoodBox(place, {x, y, height - 0.035}, {width, depth, 0.035}, tone);
  for (const double lx : {x + 0.04, -x - 0.04 - leg}) {
    for (const double ly : {y + 0.04, -y - 0.04 - leg}) {
      Box(place, {lx, ly, 0}, {leg, leg, height - 0.035}, BoxFaces::All(builder_.Tone(tone * 0.7)));
    }
  }
  Shade(place, {x, y, height - 0.05}, {width, depth, 0.05});
}

void Furnisher::Chair(const Place& place) {
  const double tone = random().Uniform(50, 150);
  const int frame = builder_.Tone(tone * 0.7);
  for (const double x : {-0.2, 0.17}) {
    Box(place, {x, -0.2, 0}, {0.03, 0.03, 0.44}, BoxFaces::All(frame));
    Box(place, {x, 0.17, 0}, {0.03, 0.03, 0.92}, BoxFaces::All(frame));
  }
  const int seat = Material(PaintFabric, 0.42, 0.42, tone + 50);
  BoxFaces faces = BoxFaces::All(builder_.Tone(tone));
  faces.top = seat;
  Box(place, {-0.21, -0.21, 0.42}, {0.42, 0.42, 0.05}, faces);
  const int back = Material(PaintFabric, 0.42, 0.32, tone + 50);
  faces = BoxFaces::All(builder_.Tone(tone));
  faces.front = faces.back = back;
  Box(place, {-0.21, 0.165, 0.6}, {0.42, 0.035, 0.32}, faces);
  Shade(place, {-0.21, -0.21, 0.38}, {0.42, 0.42, 0.08});
}

void Furnisher::BookRow(const Place& place, double width, double depth, double height) {
  double x = -width / 2;
  while (true) {
    const double thick = random().Uniform(0.018, 0.055);
    if (x + thick > width / 2) break;
    const double tall = height * random().Uniform(0.68, 0.98),
                 deep = depth * random().Uniform(0.75, 0.95);
    if (random().Uniform() < 0.1) {  // a gap
      x += thick * 1.5;
      continue;
    }
    const int side = builder_.Tone(10 * std::round(random().Uniform(4, 20)));
    BoxFaces faces{Picture(PaintSpine, thick, tall), -1, side, side, builder_.Tone(205), -1};
    Box(place, {x, -depth / 2 + (depth - deep) * 0.5, 0}, {thick - 0.001, deep, tall}, faces);
    x += thick;
  }
}

void Furnisher::Shelf(const Place& place, double width, double depth, double height) {
  const double tone = random().Uniform(110, 200), board = 0.022;
  const double x = -width / 2, y = -depth / 2;
  WoodBox(place, {x, y, 0}, {board, depth, height}, tone);
  WoodBox(place, {-x - board, y, 0}, {board, depth, height}, tone);
  const int back = Material(PaintWood, width, height, tone * 0.75, 0.6);
  Box(place, {x + board, -y - 0.01, 0}, {width - 2 * board, 0.01, height},
      {back, -1, -1, -1, -1, -1});
  const int rows = std::max(2, static_cast<int>(height / 0.36));
  const double pitch = (height - board) / rows;
  for (int row = 0; row <= rows; ++row) {
    const double z = row * pitch;
    WoodBox(place, {x + board, y, z}, {width - 2 * board, depth - 0.01, board}, tone);
    if (row == rows) break;
    const Place inside = place.At(0, 0.01, z + board);
    const double kind = random().Uniform();
    if (kind < 0.75) {
      BookRow(inside, width - 2 * board - 0.02, depth - 0.03, pitch - board - 0.03);
    } else {
      Clutter(inside, width - 0.1, depth - 0.08, 4);
    }
  }
  Shade(place, {x, y, 0}, {width, depth, height});
}

void Furnisher::Cabinet(const Place& place, double width, double depth, double height, int rows,
                        int columns) {
  const double tone = random().Uniform(70, 190);
  const double density = density_;
  const int front = builder_.Paint([=](Random& r) {
    return PaintDrawers(r, {static_cast<int>(width * density), static_cast<int>(height * density)},
                        rows, columns, tone);
  });
  const int side = Material(PaintWood, depth, height, tone);
  BoxFaces faces{front, side, side, side, Material(PaintWood, width, depth, tone), -1};
  Box(place, {-width / 2, -depth / 2, 0}, {width, depth, height}, faces);
  Shade(place, {-width / 2, -depth / 2, 0}, {width, depth, height});
}

void Furnisher::Sofa(const Place& place, double width) {
  const double tone = random().Uniform(60, 170);
  const auto cushion = [&](const Vector3d& corner, const Vector3d& size) {
    BoxFaces faces;
    faces.front = Material(PaintFabric, size.x(), size.z(), tone);
    faces.back = faces.front;
    faces.top = Material(PaintFabric, size.x(), size.y(), tone);
    faces.left = faces.right = Material(PaintFabric, size.y(), size.z(), tone);
    Box(place, corner, size, faces);
  };
  const double x = -width / 2;
  cushion({x, -0.42, 0.05}, {width, 0.84, 0.25});
  for (int i = 0; i < 2; ++i)
    cushion({x + 0.15 + i * (width - 0.3) / 2, -0.42, 0.3}, {(width - 0.3) / 2 - 0.01, 0.62, 0.14});
  cushion({x, 0.2, 0.3}, {width, 0.22, 0.5});
  for (const double side : {x, -x - 0.15}) cushion({side, -0.42, 0.3}, {0.15, 0.62, 0.3});
  const int pillow = Material(PaintFabric, 0.4, 0.4, tone + 60);
  Box(place.At(x + 0.45, 0.1, 0.44, 0.3), {-0.2, -0.06, 0}, {0.4, 0.12, 0.38},
      {pillow, pillow, pillow, pillow, pillow, -1});
  Shade(place, {x, -0.42, 0}, {width, 0.84, 0.45});
  Shade(place, {x, 0.2, 0}, {width, 0.22, 0.8});
}

void Furnisher::Bed(const Place& place) {
  const int blanket = Picture(PaintRug, 1.4, 2.0);
  const int side = Material(PaintFabric, 2.0, 0.35, 120);
  Box(place, {-0.7, -1.0, 0.12}, {1.4, 2.0, 0.36}, {side, side, side, side, blanket, -1});
  const int pillow = Material(PaintFabric, 0.6, 0.4, 205);
  Box(place, {-0.32, 0.5, 0.48}, {0.64, 0.4, 0.12}, BoxFaces::All(pillow));
  WoodBox(place, {-0.74, 1.0, 0}, {1.48, 0.05, 1.0}, 110);
  Shade(place, {-0.7, -1.0, 0}, {1.4, 2.0, 0.48});
}

void Furnisher::FloorLamp(const Place& place) {
  Round(place, 0, 0, 0, 0.03, 0.15, 0.14, builder_.Tone(60));
  Round(place, 0, 0, 0.03, 1.5, 0.013, 0.013, builder_.Tone(70));
  Round(place, 0, 0, 1.42, 0.3, 0.2, 0.12, Picture(PaintBand, 1.2, 0.3));
}

void Furnisher::PottedPlant(const Place& place, double height) {
  const double pot = height * 0.22;
  Round(place, 0, 0, 0, pot, pot * 0.45, pot * 0.6, Picture(PaintBand, pot * 4, pot));
  Round(place, 0, 0, 0, height * 0.6, 0.012, 0.01, builder_.Tone(70));
  for (int i = 0; i < 7; ++i) {
    const double turn = random().Uniform(0, 6.28), off = height * random().Uniform(0.05, 0.16);
    const double r = height * random().Uniform(0.1, 0.17);
    Ball(place, off * std::cos(turn), off * std::sin(turn), height * random().Uniform(0.45, 0.9),
         {r, r, r * 0.8}, Picture(PaintLeaves, 6 * r, 3 * r));
  }
}

void Furnisher::Cartons(const Place& place, int count) {
  double z = 0;
  for (int i = 0; i < count; ++i) {
    const double w = random().Uniform(0.35, 0.5), d = random().Uniform(0.3, 0.4),
                 h = random().Uniform(0.22, 0.36);
    const double turn = random().Uniform(-0.2, 0.2);
    const double y = random().Uniform(-0.04, 0.04), x = random().Uniform(-0.04, 0.04);
    const Place here = place.At(x, y, z, turn);
    BoxFaces faces{Picture(PaintCarton, w, h), Picture(PaintCarton, w, h),
                   Picture(PaintCarton, d, h), Picture(PaintCarton, d, h),
                   Picture(PaintCarton, w, d), -1};
    Box(here, {-w / 2, -d / 2, 0}, {w, d, h}, faces);
    Shade(here, {-w / 2, -d / 2, 0}, {w, d, h});
    z += h;
  }
}

void Furnisher::Monitor(const Place& place) {
  const int dark = builder_.Tone(40);
  Box(place, {-0.13, -0.1, 0}, {0.26, 0.2, 0.015}, BoxFaces::All(dark));
  Box(place, {-0.03, 0.02, 0}, {0.06, 0.03, 0.2}, BoxFaces::All(dark));
  BoxFaces faces = BoxFaces::All(dark);
  faces.front = Picture(PaintScreen, 0.54, 0.33);
  Box(place, {-0.27, -0.02, 0.12}, {0.54, 0.04, 0.33}, faces);
  Shade(place, {-0.27, -0.02, 0.12}, {0.54, 0.04, 0.33});
}

void Furnisher::Mug(const Place& place) {
  const double r = random().Uniform(0.036, 0.05), h = random().Uniform(0.085, 0.12);
  Round(place, 0, 0, 0, h, r, r * random().Uniform(0.95, 1.2), Picture(PaintBand, 6.28 * r, h));
  Ball(place, 0, 0, h * 0.9, {r * 0.95, r * 0.95, 0.004}, builder_.Tone(45));
}

void Furnisher::BookPile(const Place& place, int count) {
  double z = 0;
  for (int i = 0; i < count; ++i) {
    const double w = random().Uniform(0.15, 0.24), d = w * random().Uniform(1.2, 1.45),
                 h = random().Uniform(0.015, 0.05);
    const Place here = place.At(0, 0, z, random().Uniform(-0.35, 0.35));
    const int pages = builder_.Tone(205), spine = Picture(PaintCover, d, h);
    Box(here, {-w / 2, -d / 2, 0}, {w, d, h},
        {pages, pages, spine, pages, Picture(PaintCover, w, d), -1});
    z += h;
  }
  Shade(place, {-0.1, -0.13, 0}, {0.2, 0.26, z});
}

void Furnisher::Pages(const Place& place, int count) {
  for (int i = 0; i < count; ++i) {
    const double turn = random().Uniform(-1.2, 1.2);
    const double y = random().Uniform(-0.15, 0.15), x = random().Uniform(-0.2, 0.2);
    const Place here = place.At(x, y, 0.0015 * i, turn);
    Box(here, {-0.105, -0.148, 0}, {0.21, 0.297, 0.001},
        {-1, -1, -1, -1, Picture(PaintPage, 0.21, 0.297), -1});
  }
}

void Furnisher::Clutter(const Place& place, double width, double depth, int count) {
  // At most one object per cell, so that they do not intersect.
  const int columns = std::max(1, static_cast<int>(width / 0.28)),
            rows = std::max(1, static_cast<int>(depth / 0.28));
  const std::vector<int> cells = random().Sample(std::min(count, columns * rows), columns * rows);
  for (const int cell : cells) {
    const double x =
        ((cell % columns) + 0.5) / columns * width - width / 2 + random().Uniform(-0.02, 0.02);
    const double y =
        ((cell / columns) + 0.5) / rows * depth - depth / 2 + random().Uniform(-0.02, 0.02);
    const Place here = place.At(x, y, 0, random().Uniform(-0.5, 0.5));
    switch (random().Below(6)) {
      case 0:
        BookPile(here, 1 + static_cast<int>(random().Below(4)));
        break;
      case 1:
        Mug(here);
        break;
      case 2:
        Pages(here, 1);
        break;
      case 3:
        PottedPlant(here, random().Uniform(0.2, 0.3));
        break;
      case 4: {
        const double r = random().Uniform(0.04, 0.07), h = random().Uniform(0.12, 0.25);
        Round(here, 0, 0, 0, h, r, r * random().Uniform(0.4, 1.1), Picture(PaintBand, 6.28 * r, h));
        break;
      }
      default: {
        const double w = random().Uniform(0.1, 0.2), h = random().Uniform(0.06, 0.2);
        BoxFaces faces{Picture(PaintCover, w, h),       Picture(PaintCover, w, h),
                       Picture(PaintCover, w * 0.7, h), Picture(PaintCover, w * 0.7, h),
                       Picture(PaintCover, w, w * 0.7), -1};
        Box(here, {-w / 2, -w * 0.35, 0}, {w, w * 0.7, h}, faces);
        Shade(here, {-w / 2, -w * 0.35, 0}, {w, w * 0.7, h});
      }
    }
  }
}

}  // namespace alidade
