// Textures of furniture and small objects.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "alidade/synth/paint/draw.h"
#include "alidade/synth/paint/paint.h"

namespace alidade {

cv::Mat PaintRug(Random& random, cv::Size size) {
  const double ground = random.Uniform(70, 150);
  cv::Mat1f picture(size, static_cast<float>(ground));
  const int side = std::min(size.width, size.height);
  for (int ring = 0; ring < 5; ++ring) {
    const int inset = side * ring / 18;
    cv::rectangle(picture, {inset, inset, size.width - 2 * inset, size.height - 2 * inset},
                  random.Uniform(40, 210), ring == 4 ? -1 : side / 22);
  }
  const int pitch = side / 7;
  for (int y = pitch * 3 / 2; y < size.height - pitch; y += pitch) {
    for (int x = pitch * 3 / 2; x < size.width - pitch; x += pitch) {
      const int r = static_cast<int>(pitch * random.Uniform(0.25, 0.5));
      const std::vector<cv::Point> diamond = {{x - r, y}, {x, y - r}, {x + r, y}, {x, y + r}};
      cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{diamond}, random.Uniform(30, 225));
      cv::circle(picture, {x, y}, std::max(1, r / 3), random.Uniform(30, 225), -1);
    }
  }
  picture += 7.0 * FractalNoise(random, size, 5, 5, 2);
  return ToGrey(picture);
}

cv::Mat PaintCarton(Random& random, cv::Size size) {
  cv::Mat1f card(size, static_cast<float>(random.Uniform(125, 165)));
  card += 4.0 * FractalNoise(random, size, size.width / 4.0, size.height / 4.0, 5, 0.6);
  cv::Mat picture = ToGrey(card);
  const int w = size.width, h = size.height;
  cv::rectangle(picture, {0, h * 2 / 5, w, h / 8}, 185, -1);  // tape
  const int top = Pick(random, h / 20, h / 8), left = Pick(random, w / 20, w / 3);
  const cv::Rect label(left, top, w / 2, h / 3);
  cv::rectangle(picture, label, 235, -1);
  WriteText(random, picture, label, h / 14.0, 30);
  int x = Pick(random, w / 10, w / 4);
  for (const int end = x + w / 2; x < end; x += 2 + Pick(random, 0, w / 40)) {  // bar code
    cv::rectangle(picture, {x, h * 3 / 4, Pick(random, 1, std::max(2, w / 70)), h / 6}, 25, -1);
  }
  return picture;
}

cv::Mat PaintDoor(Random& random, cv::Size size, int number) {
  cv::Mat picture = PaintWood(random, {size.height, size.width}, size.height / 2.0, 135);
  cv::rotate(picture, picture, cv::ROTATE_90_CLOCKWISE);
  const int w = size.width, h = size.height;
  for (int row = 0; row < 2; ++row) {
    const cv::Rect panel(w / 7, h / 10 + row * h * 9 / 20, w * 5 / 7, h * 7 / 20);
    cv::rectangle(picture, panel, 70, std::max(2, w / 60));
    cv::rectangle(picture,
                  {panel.x + w / 30, panel.y + w / 30, panel.width - w / 15, panel.height - w / 15},
                  175, std::max(1, w / 120));
  }
  DrawFrame(picture, w / 22, 205);
  cv::rectangle(picture, {w * 5 / 6, h / 2 - h / 30, w / 14, h / 12}, 60, -1);  // handle
  cv::line(picture, {w * 43 / 50, h / 2}, {w * 37 / 50, h / 2}, 230, std::max(2, w / 40),
           cv::LINE_AA);
  cv::rectangle(picture, {w * 3 / 8, h / 5, w / 4, h / 16}, 235, -1);
  cv::putText(picture, std::to_string(number), {w * 3 / 8 + w / 30, h / 5 + h / 20},
              cv::FONT_HERSHEY_SIMPLEX, h / 16.0 / 34, 20, std::max(1, h / 300), cv::LINE_AA);
  return picture;
}

cv::Mat PaintDrawers(Random& random, cv::Size size, int rows, int columns, double tone) {
  cv::Mat picture = PaintWood(random, size, size.width / 0.8, tone);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const cv::Rect front(column * size.width / columns, row * size.height / rows,
                           size.width / columns, size.height / rows);
      const int line = std::max(2, size.width / 130);
      cv::rectangle(picture, front, tone * 0.45, line);
      const cv::Point handle(front.x + front.width / 2, front.y + front.height / 3);
      cv::rectangle(picture, {handle.x - size.width / 24, handle.y, size.width / 12, 2 * line},
                    tone > 110 ? 35 : 220, -1);
    }
  }
  return picture;
}

cv::Mat PaintWindow(Random& random, cv::Size size) {
  cv::Mat picture = Blank(size, 240);
  const int w = size.width, h = size.height;
  for (int y = 0; y < h; ++y) picture.row(y) = 245 - 25.0 * y / h;
  for (int i = 0; i < 5; ++i) {  // houses with windows
    const int across = Pick(random, w / 6, w / 3), roof = Pick(random, h * 2 / 5, h * 7 / 10);
    const cv::Rect house(Pick(random, -w / 10, w), roof, across, h);
    cv::rectangle(picture, house, random.Uniform(120, 210), -1);
    for (int y = house.y + h / 30; y < h; y += h / 11) {
      for (int x = house.x + w / 40; x < house.x + house.width - w / 30; x += w / 18) {
        cv::rectangle(picture, {x, y, w / 36, h / 20}, random.Uniform(50, 100), -1);
      }
    }
  }
  for (int tree = 0; tree < 3; ++tree) {
    const cv::Point foot(Pick(random, 0, w), h);
    cv::line(picture, foot, {foot.x, h * 3 / 5}, 60, std::max(2, w / 50));
    for (int i = 0; i < 60; ++i) {
      const double tone = random.Uniform(60, 150);
      const int dx = Pick(random, -w / 8, w / 8), dy = Pick(random, -h / 7, h / 7);
      cv::circle(picture, {foot.x + dx, h * 3 / 5 + dy}, std::max(2, w / 50), tone, -1,
                 cv::LINE_AA);
    }
  }
  cv::line(picture, {w / 2, 0}, {w / 2, h}, 215, std::max(3, w / 25));
  cv::line(picture, {0, h / 3}, {w, h / 3}, 215, std::max(3, w / 30));
  DrawFrame(picture, w / 18, 205);
  return picture;
}

cv::Mat PaintRadiator(Random& random, cv::Size size) {
  cv::Mat1f picture(size);
  const double pitch = size.width / 14.0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      picture(y, x) = static_cast<float>(170 + 45 * std::cos(2 * 3.14159265 * x / pitch));
    }
  }
  picture += 3.0 * FractalNoise(random, size, 20, 20, 2);
  cv::Mat grey = ToGrey(picture);
  cv::rectangle(grey, {0, 0, size.width, size.height / 12}, 215, -1);
  cv::rectangle(grey, {0, size.height * 11 / 12, size.width, size.height / 12}, 200, -1);
  return grey;
}

cv::Mat PaintLeaves(Random& random, cv::Size size) {
  cv::Mat picture = Blank(size, 55);
  const int side = std::min(size.width, size.height);
  for (int i = 0; i < 160; ++i) {
    const cv::Point p = PickPoint(random, size);
    const double turn = random.Uniform(0, 360), tone = random.Uniform(45, 165);
    const int r = std::max(3, static_cast<int>(side * random.Uniform(0.04, 0.1)));
    cv::ellipse(picture, p, {r, std::max(1, r / 3)}, turn, 0, 360, tone, -1, cv::LINE_AA);
    cv::ellipse(picture, p, {r, std::max(1, r / 3)}, turn, 0, 360, tone * 0.6, 1, cv::LINE_AA);
  }
  return picture;
}

cv::Mat PaintBand(Random& random, cv::Size size) {
  const double ground = random.Uniform(60, 225), ink = Contrasting(random, ground, 70);
  cv::Mat picture = Blank(size, ground);
  const int w = size.width, h = size.height;
  cv::rectangle(picture, {0, h / 8, w, h / 10}, ink, -1);
  cv::rectangle(picture, {0, h * 3 / 4, w, h / 10}, ink, -1);
  for (int i = 0; i < 8; ++i) {
    const int x = w * (2 * i + 1) / 16;
    const double tone = random.Uniform(20, 235);
    cv::circle(picture, {x, h / 2}, Pick(random, h / 16, h / 7), tone, -1, cv::LINE_AA);
  }
  return picture;
}

}  // namespace alidade
