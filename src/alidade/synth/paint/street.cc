// Textures of streets.
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "alidade/synth/paint/draw.h"
#include "alidade/synth/paint/paint.h"

namespace alidade {
namespace {

// A window: frame, dark glass, bright sky in the upper part, and often a curtain.
void DrawPane(Random& random, cv::Mat& facade, const cv::Rect& box, double frame) {
  const cv::Rect inside = box & cv::Rect({0, 0}, facade.size());
  if (inside.area() <= 0) return;
  cv::Mat pane = facade(inside);
  const double glass = random.Uniform(35, 85), sky = random.Uniform(90, 170);
  const int horizon = Pick(random, pane.rows / 4, pane.rows * 3 / 4);
  pane = glass;
  pane.rowRange(0, horizon) = sky;
  if (random.Uniform() < 0.5) {
    const int hem = Pick(random, pane.rows / 3, pane.rows);
    const double cloth = random.Uniform(150, 220);
    pane(cv::Rect(0, 0, pane.cols / 3, hem)) = cloth;
    pane(cv::Rect(pane.cols - pane.cols / 3, 0, pane.cols / 3, hem)) = cloth;
  }
  const int wide = std::max(1, pane.cols / 12);
  cv::line(pane, {pane.cols / 2, 0}, {pane.cols / 2, pane.rows}, frame, wide);
  cv::rectangle(pane, {0, 0, pane.cols, pane.rows}, frame, wide);
}

// Ground floor: a door, and shop windows with a sign above.
void DrawGroundFloor(Random& random, cv::Mat& facade, double density, double frame) {
  const int top = facade.rows - static_cast<int>(3.1 * density), width = facade.cols;
  const double band = random.Uniform(60, 220);
  const cv::Rect sign(0, std::max(0, top), width, static_cast<int>(0.55 * density));
  cv::rectangle(facade, sign, band, -1);
  const double ink = Contrasting(random, band, 90);
  WriteText(random, facade, sign, 0.4 * density, ink);
  const int door_width = static_cast<int>(1.0 * density), tall = static_cast<int>(2.3 * density);
  const int door = Pick(random, width / 10, std::max(width / 10, width - 2 * door_width));
  for (int x = width / 20; x + static_cast<int>(1.8 * density) < width;
       x += static_cast<int>(2.2 * density)) {
    const cv::Rect shop(x, facade.rows - static_cast<int>(2.2 * density),
                        static_cast<int>(1.8 * density), static_cast<int>(1.7 * density));
    DrawPane(random, facade, shop, frame);
    const int figures = Pick(random, 1, 4);
    for (int i = 0; i < figures; ++i) {
      cv::Mat wares = facade(shop & cv::Rect({0, 0}, facade.size()));
      DrawShape(random, wares, 0.05 * density, 0.3 * density);
    }
  }
  const double leaf = random.Uniform(40, 190);
  cv::rectangle(facade, {door, facade.rows - tall, door_width, tall}, leaf, -1);
  cv::rectangle(facade, {door, facade.rows - tall, door_width, tall}, frame,
                std::max(1, door_width / 14));
}

}  // namespace

cv::Mat PaintFacade(Random& random, cv::Size size, double density, double tone) {
  cv::Mat facade = random.Uniform() < 0.5 ? PaintBricks(random, size, density, tone)
                                          : PaintPlaster(random, size, density, tone + 30);
  const double frame = random.Uniform() < 0.7 ? 225 : 60;
  const double floor = random.Uniform(2.8, 3.4) * density,
               pitch = random.Uniform(1.7, 2.8) * density;
  const double wide = random.Uniform(0.45, 0.65) * pitch, tall = random.Uniform(0.45, 0.62) * floor;
  const int columns = std::max(1, static_cast<int>(size.width / pitch));
  const double margin = (size.width - columns * pitch) / 2;
  // From bottom to top; the ground floor is 3.1 m high.
  for (double foot = size.height - 3.1 * density; foot - floor > -0.3 * floor; foot -= floor) {
    for (int i = 0; i < columns; ++i) {
      const double x = margin + i * pitch + (pitch - wide) / 2;
      DrawPane(random, facade,
               {static_cast<int>(x), static_cast<int>(foot - 0.2 * floor - tall),
                static_cast<int>(wide), static_cast<int>(tall)},
               frame);
    }
    cv::line(facade, {0, static_cast<int>(foot)}, {size.width, static_cast<int>(foot)}, tone - 25,
             std::max(1, static_cast<int>(0.06 * density)));
  }
  DrawGroundFloor(random, facade, density, frame);
  return facade;
}

cv::Mat PaintAsphalt(Random& random, cv::Size size, double density, double tone) {
  const cv::Mat1f stones = FractalNoise(random, size, 0.06 * density, 0.06 * density, 3, 0.8);
  const cv::Mat1f wear = FractalNoise(random, size, 2 * density, 2 * density, 4, 0.6);
  cv::Mat1f picture = 9.0 * stones + 12.0 * wear + tone;
  for (int patch = Pick(random, 1, 3); patch > 0; --patch) {  // repaired patches
    const cv::Point at = PickPoint(random, size);
    const int across =
        Pick(random, static_cast<int>(0.4 * density), static_cast<int>(1.5 * density));
    const double own = tone + random.Uniform(-35, 25);
    picture(cv::Rect(at, cv::Size(across, across)) & cv::Rect({0, 0}, size)) =
        static_cast<float>(own);
  }
  for (int crack = Pick(random, 2, 5); crack > 0; --crack) {
    cv::Point from = PickPoint(random, size);
    for (int i = 0; i < 8; ++i) {
      const int dx =
          Pick(random, -static_cast<int>(0.5 * density), static_cast<int>(0.5 * density));
      const int dy =
          Pick(random, -static_cast<int>(0.5 * density), static_cast<int>(0.5 * density));
      cv::line(picture, from, from + cv::Point(dx, dy), tone - 50, 1, cv::LINE_AA);
      from += cv::Point(dx, dy);
    }
  }
  return ToGrey(picture);
}

}  // namespace alidade
