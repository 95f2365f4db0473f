#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/synth/paint/paint.h"

namespace alidade {
namespace {

cv::Mat1f Plain(cv::Size size, double tone) { return cv::Mat1f(size, static_cast<float>(tone)); }

cv::Rect Clip(const cv::Rect& rect, cv::Size size) { return rect & cv::Rect({0, 0}, size); }

// Row before column in separate statements: the order of function arguments depends on the
// compiler.
cv::Point PickTexel(Random& random, cv::Size size) {
  const int y = static_cast<int>(random.Below(size.height));
  return {static_cast<int>(random.Below(size.width)), y};
}

// Soft dark or light spots; `per_square_metre`: number per square meter.
void AddStains(Random& random, cv::Mat1f& picture, double density, double per_square_metre,
               double strength) {
  const double area = picture.cols / density * (picture.rows / density);
  const int count = static_cast<int>(area * per_square_metre);
  for (int i = 0; i < count; ++i) {
    const double radius = density * random.Uniform(0.01, 0.05);
    const cv::Point centre = PickTexel(random, picture.size());
    const int reach = static_cast<int>(radius * 2.5) + 2;
    const cv::Rect box =
        Clip({centre.x - reach, centre.y - reach, 2 * reach, 2 * reach}, picture.size());
    const double depth = strength * random.Uniform(-1, 0.5), squeeze = random.Uniform(0.6, 1.6);
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) {
        const double dx = (x - centre.x) / radius * squeeze, dy = (y - centre.y) / radius;
        picture(y, x) += static_cast<float>(depth * std::exp(-0.5 * (dx * dx + dy * dy)));
      }
    }
  }
}

}  // namespace

cv::Mat1f FractalNoise(Random& random, cv::Size size, double cell_x, double cell_y, int octaves,
                       double gain) {
  cv::Mat1f sum(size, 0.0f), layer;
  double amplitude = 1;
  for (int octave = 0; octave < octaves; ++octave) {
    const int columns = std::min(size.width, static_cast<int>(size.width / cell_x) + 3);
    const int rows = std::min(size.height, static_cast<int>(size.height / cell_y) + 3);
    cv::Mat1f lattice(std::max(1, rows), std::max(1, columns));
    for (float& value : lattice) value = static_cast<float>(random.Uniform(-1, 1));
    cv::resize(lattice, layer, size, 0, 0, cv::INTER_CUBIC);
    sum += amplitude * layer;
    amplitude *= gain;
    cell_x = std::max(1.0, cell_x / 2);
    cell_y = std::max(1.0, cell_y / 2);
  }
  return sum;
}

cv::Mat ToGrey(const cv::Mat1f& picture) {
  cv::Mat grey;
  picture.convertTo(grey, CV_8U);
  return grey;
}

cv::Mat PaintPlaster(Random& random, cv::Size size, double density, double tone) {
  const cv::Mat1f fine = FractalNoise(random, size, 0.02 * density, 0.02 * density, 2);
  const cv::Mat1f coarse = FractalNoise(random, size, density, density, 2);
  cv::Mat1f picture = Plain(size, tone) + 3.0 * coarse + 1.2 * fine;
  AddStains(random, picture, density, 0.8, 9);
  return ToGrey(picture);
}

cv::Mat PaintBricks(Random& random, cv::Size size, double density, double tone) {
  cv::Mat1f picture = Plain(size, tone + 45) + 6.0 * FractalNoise(random, size, 8, 8, 2);
  const double height = 0.075 * density, width = 0.22 * density, mortar = 0.011 * density;
  for (int row = 0; row * height < size.height; ++row) {
    for (int column = -1; column * width < size.width; ++column) {
      const double x = column * width + (row % 2) * width / 2;
      const cv::Rect box =
          Clip({static_cast<int>(x + random.Uniform(0, 2)),
                static_cast<int>(row * height + random.Uniform(0, 2)),
                static_cast<int>(width - mortar), static_cast<int>(height - mortar)},
               size);
      const double own = tone + 16 * random.Gaussian();
      if (box.area() > 0) picture(box) = static_cast<float>(own);
    }
  }
  picture += 7.0 * FractalNoise(random, size, 0.03 * density, 0.03 * density, 3, 0.7);
  return ToGrey(picture);
}

cv::Mat PaintPlanks(Random& random, cv::Size size, double density, double tone) {
  cv::Mat1f picture(size);
  const double width = 0.125 * density;
  for (int row = 0; row * width < size.height; ++row) {
    double x = -random.Uniform(0, 1.0) * density;
    while (x < size.width) {
      const double length = random.Uniform(0.6, 1.5) * density;
      const cv::Rect box = Clip({static_cast<int>(x), static_cast<int>(row * width),
                                 static_cast<int>(length) + 1, static_cast<int>(width) + 1},
                                size);
      x += length;
      if (box.area() <= 0) continue;
      const double own = tone + 11 * random.Gaussian();
      cv::Mat1f plank = picture(box);
      plank = Plain(box.size(), own) +
              7.0 * FractalNoise(random, box.size(), 0.35 * density, 0.02 * density, 4, 0.7);
      if (random.Uniform() < 0.45) {  // a knot
        const cv::Point centre = PickTexel(random, box.size());
        const double r = density * random.Uniform(0.006, 0.014);
        cv::ellipse(plank, centre, {static_cast<int>(2.2 * r) + 1, static_cast<int>(1.3 * r) + 1},
                    0, 0, 360, own - 14, -1, cv::LINE_AA);
        cv::ellipse(plank, centre, {static_cast<int>(1.2 * r) + 1, static_cast<int>(0.7 * r) + 1},
                    0, 0, 360, own - 50, -1, cv::LINE_AA);
      }
      const int gap = std::max(1, static_cast<int>(0.003 * density));
      plank(cv::Rect(0, 0, plank.cols, std::min(gap, plank.rows))) *= 0.55f;
      plank(cv::Rect(0, 0, std::min(gap, plank.cols), plank.rows)) *= 0.45f;
    }
  }
  AddStains(random, picture, density, 2, 12);
  return ToGrey(picture);
}

cv::Mat PaintTiles(Random& random, cv::Size size, double density, double tone) {
  cv::Mat1f picture = Plain(size, tone - 45) + 5.0 * FractalNoise(random, size, 6, 6, 2);
  const double side = 0.3 * density, gap = 0.006 * density;
  for (int row = 0; row * side < size.height; ++row) {
    for (int column = 0; column * side < size.width; ++column) {
      const cv::Rect box = Clip({static_cast<int>(column * side), static_cast<int>(row * side),
                                 static_cast<int>(side - gap), static_cast<int>(side - gap)},
                                size);
      if (box.area() <= 0) continue;
      cv::Mat1f tile = picture(box);
      const cv::Mat1f veins =
          FractalNoise(random, box.size(), 0.2 * density, 0.1 * density, 4, 0.7);
      const double own = tone + 9 * random.Gaussian() + ((row + column) % 2 == 0 ? 12 : -12);
      tile = Plain(box.size(), own) + 6.0 * veins;
      for (int speck = 0; speck < 14; ++speck) {  // terrazzo
        const cv::Point centre = PickTexel(random, box.size());
        const double r = density * random.Uniform(0.003, 0.012);
        const double own_tone = tone + random.Uniform(-60, 50), turn = random.Uniform(0, 180);
        cv::ellipse(tile, centre, {static_cast<int>(r) + 1, static_cast<int>(r * 0.6) + 1}, turn, 0,
                    360, own_tone, -1, cv::LINE_AA);
      }
    }
  }
  AddStains(random, picture, density, 2, 10);
  return ToGrey(picture);
}

cv::Mat PaintCarpet(Random& random, cv::Size size, double density, double tone) {
  const cv::Mat1f pile = FractalNoise(random, size, 0.025 * density, 0.025 * density, 3, 0.8);
  const cv::Mat1f wear = FractalNoise(random, size, 0.7 * density, 0.7 * density, 3);
  cv::Mat1f picture = Plain(size, tone) + 6.0 * wear + 9.0 * pile;
  const int flecks = static_cast<int>(size.area() / (density * density) * 60);
  for (int i = 0; i < flecks; ++i) {
    const cv::Point centre = PickTexel(random, size);
    const double r = density * random.Uniform(0.004, 0.014);
    const double own = tone + random.Uniform(-50, 45), turn = random.Uniform(0, 180);
    cv::ellipse(picture, centre, {static_cast<int>(r) + 1, static_cast<int>(r * 0.5) + 1}, turn, 0,
                360, own, -1, cv::LINE_AA);
  }
  AddStains(random, picture, density, 3, 14);
  return ToGrey(picture);
}

cv::Mat PaintWood(Random& random, cv::Size size, double density, double tone) {
  const cv::Mat1f shade = FractalNoise(random, size, 0.4 * density, 0.3 * density, 2);
  const cv::Mat1f grain = FractalNoise(random, size, 0.5 * density, 0.03 * density, 5, 0.65);
  cv::Mat1f picture = Plain(size, tone) + 9.0 * grain + 5.0 * shade;
  AddStains(random, picture, density, 2.5, 22);
  return ToGrey(picture);
}

cv::Mat PaintFabric(Random& random, cv::Size size, double density, double tone) {
  const cv::Mat1f weave = FractalNoise(random, size, 4, 4, 2);
  const cv::Mat1f folds = FractalNoise(random, size, 0.3 * density, 0.3 * density, 3);
  cv::Mat1f picture = Plain(size, tone) + 7.0 * folds + 4.0 * weave;
  const uint32_t kind = random.Below(3);
  const double pitch = density * random.Uniform(0.06, 0.14);
  for (int y = 0; y < size.height && kind > 0; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool stripe = std::fmod(x / pitch, 1.0) < 0.35,
                 cross = std::fmod(y / pitch, 1.0) < 0.35;
      if (stripe) picture(y, x) += 26;
      if (kind == 2 && cross) picture(y, x) -= 24;
    }
  }
  return ToGrey(picture);
}

}  // namespace alidade
