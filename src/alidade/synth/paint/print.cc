// Printed, written and drawn textures.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "alidade/synth/paint/draw.h"
#include "alidade/synth/paint/paint.h"

namespace alidade {
namespace {

// Landscape as in a framed photograph: hills under a sky, with random brightness, ruggedness and
// scale.
void DrawLandscape(Random& random, cv::Mat picture) {
  const cv::Size size = picture.size();
  const double zenith = random.Uniform(60, 235), horizon = random.Uniform(120, 240);
  for (int y = 0; y < size.height; ++y)
    picture.row(y) = zenith + (horizon - zenith) * y / size.height;
  for (int disc = Pick(random, 0, 2); disc > 0; --disc) {
    const double tone = Contrasting(random, zenith, 40);
    const int r = Pick(random, size.width / 24, size.width / 6);
    const int x = Pick(random, 0, size.width), y = Pick(random, 0, size.height / 2);
    cv::circle(picture, {x, y}, r, tone, -1, cv::LINE_AA);
  }
  const int ridges = Pick(random, 1, 5);
  const double rough = random.Uniform(0.3, 0.75), wide = random.Uniform(1.5, 6);
  const double near = random.Uniform(25, 210), far = Contrasting(random, horizon, 40);
  for (int ridge = 0; ridge < ridges; ++ridge) {
    const cv::Mat1f line = FractalNoise(random, {size.width, 1}, size.width / wide, 1, 5, rough);
    const double base = size.height * (0.3 + 0.6 * ridge / ridges),
                 tone = far + (near - far) * (ridge + 1) / ridges;
    for (int x = 0; x < size.width; ++x) {
      const int top =
          std::clamp(static_cast<int>(base - 0.12 * size.height * line(0, x)), 0, size.height - 1);
      picture(cv::Rect(x, top, 1, size.height - top)) = tone;
    }
  }
  const double trunk = random.Uniform(10, 60);
  for (int tree = Pick(random, 0, 7); tree > 0; --tree) {  // firs in front
    const int x = Pick(random, 0, size.width),
              tall = Pick(random, size.height / 8, size.height / 2),
              foot = Pick(random, size.height * 3 / 4, size.height);
    const std::vector<cv::Point> fir = {
        {x, foot - tall}, {x + tall / 5, foot}, {x - tall / 5, foot}};
    cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{fir}, trunk, cv::LINE_AA);
  }
  cv::Mat1f grain;
  picture.convertTo(grain, CV_32F);
  grain += 14.0 * FractalNoise(random, size, size.width / 12.0, size.height / 20.0, 4, 0.75);
  ToGrey(grain).copyTo(picture);
}

}  // namespace

cv::Mat PaintPoster(Random& random, cv::Size size) {
  const double ground = random.Uniform() < 0.6 ? random.Uniform(190, 240) : random.Uniform(25, 110);
  cv::Mat picture = Blank(size, ground);
  const int w = size.width, h = size.height, side = std::min(w, h);
  switch (random.Below(4)) {
    case 0:  // overlapping shapes
      for (int i = 0; i < 16; ++i) DrawShape(random, picture, side * 0.05, side * 0.22);
      WriteText(random, picture, {w / 12, h * 3 / 4, w * 5 / 6, h / 5}, h / 14.0,
                Contrasting(random, ground, 90));
      break;
    case 1: {  // photograph with a caption
      DrawLandscape(random, picture(cv::Rect(w / 16, h / 16, w - w / 8, h * 5 / 8)));
      WriteText(random, picture, {w / 12, h * 23 / 32, w * 5 / 6, h / 5}, h / 18.0,
                Contrasting(random, ground, 90));
      break;
    }
    case 2: {  // text and figures, like a conference poster
      cv::rectangle(picture, {0, 0, w, h / 7}, Contrasting(random, ground), -1);
      WriteText(random, picture, {w / 20, h / 40, w * 9 / 10, h / 9}, h / 15.0, ground);
      const double ink = Contrasting(random, ground, 110);
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 2; ++column) {
          const cv::Rect box(w / 24 + column * w / 2, h / 6 + row * h * 5 / 18, w * 5 / 12, h / 4);
          if (random.Uniform() < 0.5) {
            WriteText(random, picture, box, h / 34.0, ink);
          } else {
            cv::Mat figure = picture(box & cv::Rect({0, 0}, size));
            figure = random.Uniform(120, 230);
            for (int i = 0; i < 6; ++i) DrawShape(random, figure, side * 0.02, side * 0.09);
          }
        }
      }
      break;
    }
    default: {  // a map: streets, blocks and names
      for (int i = 0; i < 70; ++i) {
        const cv::Point a = PickPoint(random, size);
        const double tone = ground + random.Uniform(-70, 50);
        const int across = Pick(random, side / 30, side / 9),
                  down = Pick(random, side / 30, side / 9);
        cv::rectangle(picture, {a.x, a.y, across, down}, tone, -1);
      }
      for (int i = 0; i < 14; ++i) {
        const double tone = Contrasting(random, ground);
        const cv::Point b = PickPoint(random, size), a = PickPoint(random, size);
        cv::line(picture, a, b, tone, std::max(1, side / 70), cv::LINE_AA);
      }
      for (int i = 0; i < 10; ++i) {
        const cv::Point a = PickPoint(random, size);
        WriteText(random, picture, {a.x, a.y, side / 4, side / 20}, side / 24.0,
                  Contrasting(random, ground, 80));
      }
    }
  }
  if (random.Uniform() < 0.6) DrawFrame(picture, std::max(2, side / 40), random.Uniform(20, 120));
  return picture;
}

cv::Mat PaintPage(Random& random, cv::Size size) {
  cv::Mat picture = Blank(size, random.Uniform(205, 240));
  const int w = size.width, h = size.height;
  WriteText(random, picture, {w / 12, h / 20, w * 5 / 6, h / 10}, h / 16.0, 30);
  WriteText(random, picture, {w / 12, h / 6, w * 5 / 6, h * 3 / 4}, h / 32.0, 60);
  if (random.Uniform() < 0.5) {
    cv::Mat figure = picture(cv::Rect(w / 8, h / 3, w / 2, h / 4));
    figure = random.Uniform(110, 190);
    for (int i = 0; i < 5; ++i) DrawShape(random, figure, w / 20.0, w / 8.0);
  }
  return picture;
}

cv::Mat PaintSpine(Random& random, cv::Size size) {
  const double ground = random.Uniform(25, 225);
  cv::Mat picture = Blank(size, ground);
  const int w = size.width, h = size.height;
  const double ink = Contrasting(random, ground, 70);
  for (int band = Pick(random, 0, 3); band > 0; --band) {
    const int y =
        random.Uniform() < 0.5 ? Pick(random, h / 20, h / 5) : Pick(random, h * 3 / 4, h * 19 / 20);
    cv::rectangle(picture, {0, y, w, std::max(2, Pick(random, h / 80, h / 18))}, ink, -1);
  }
  // The title runs along the spine.
  cv::Mat lying = Blank({h, w}, ground), standing;
  WriteText(random, lying, {h / 4, w / 8, h / 2, w * 3 / 4}, w * 0.42, ink);
  cv::rotate(lying, standing, cv::ROTATE_90_CLOCKWISE);
  standing.rowRange(h / 4, h * 3 / 4).copyTo(picture.rowRange(h / 4, h * 3 / 4));
  return picture;
}

cv::Mat PaintCover(Random& random, cv::Size size) {
  const double ground = random.Uniform(40, 220);
  cv::Mat picture = Blank(size, ground);
  const int w = size.width, h = size.height;
  for (int i = 0; i < 4; ++i) DrawShape(random, picture, w * 0.08, w * 0.25);
  WriteText(random, picture, {w / 10, h / 8, w * 4 / 5, h / 4}, h / 11.0,
            Contrasting(random, ground, 90));
  WriteText(random, picture, {w / 10, h * 4 / 5, w * 4 / 5, h / 8}, h / 20.0,
            Contrasting(random, ground, 90));
  return picture;
}

cv::Mat PaintScreen(Random& random, cv::Size size) {
  cv::Mat picture = Blank(size, random.Uniform(40, 90));
  const int w = size.width, h = size.height;
  for (int i = 0; i < 4; ++i) {
    const int down = Pick(random, h / 4, h / 2), across = Pick(random, w / 4, w / 2);
    const int y = Pick(random, 0, h / 2), x = Pick(random, 0, w / 2);
    const cv::Rect window(x, y, across, down);
    const double ground = random.Uniform() < 0.5 ? 235 : 35;
    cv::rectangle(picture, window, ground, -1);
    cv::rectangle(picture, {window.x, window.y, window.width, h / 24}, 130, -1);
    WriteText(random, picture,
              {window.x + 2, window.y + h / 20, window.width - 4, window.height - h / 16}, h / 28.0,
              270 - ground);
  }
  DrawFrame(picture, w / 40, 25);
  return picture;
}

cv::Mat PaintKeyboard(Random& random, cv::Size size) {
  cv::Mat picture = Blank(size, 55);
  const double key = size.height / 5.6;
  for (int row = 0; row < 5; ++row) {
    double x = key * 0.3;
    for (int column = 0; x < size.width - key; ++column) {
      const double width = key * (row == 4 && column == 3 ? 5 : (column == 0 ? 1 + 0.25 * row : 1));
      const cv::Rect cap(static_cast<int>(x), static_cast<int>(key * (0.3 + row)),
                         static_cast<int>(width * 0.86), static_cast<int>(key * 0.84));
      cv::rectangle(picture, cap, 105, -1);
      const std::string letter(1, static_cast<char>('A' + random.Below(26)));
      cv::putText(picture, letter,
                  {cap.x + static_cast<int>(key / 5), cap.y + static_cast<int>(key * 0.6)},
                  cv::FONT_HERSHEY_SIMPLEX, key / 60, 225, std::max(1, static_cast<int>(key / 25)),
                  cv::LINE_AA);
      x += width;
    }
  }
  return picture;
}

cv::Mat PaintBoard(Random& random, cv::Size size) {
  cv::Mat picture = Blank(size, 226);
  const int w = size.width, h = size.height, pen = std::max(2, w / 260);
  for (int i = 0; i < 6; ++i) {
    if (random.Uniform() < 0.2) continue;
    const cv::Rect area(w / 20 + (i % 3) * w * 3 / 10 + Pick(random, 0, w / 30),
                        h / 10 + (i / 3) * h * 9 / 20, w / 4, h * 7 / 20);
    const double ink = random.Uniform(30, 120);
    switch (random.Below(3)) {
      case 0:
        WriteText(random, picture, area, h / 14.0, ink);
        break;
      case 1: {  // axes and a curve
        cv::line(picture, {area.x, area.y + area.height},
                 {area.x + area.width, area.y + area.height}, ink, pen, cv::LINE_AA);
        cv::line(picture, {area.x, area.y}, {area.x, area.y + area.height}, ink, pen, cv::LINE_AA);
        cv::Point last(area.x, area.y + area.height / 2);
        for (int x = 0; x < area.width; x += 12) {
          const cv::Point next(area.x + x, area.y + area.height / 2 +
                                               Pick(random, -area.height / 3, area.height / 3));
          cv::line(picture, last, next, ink, pen, cv::LINE_AA);
          last = next;
        }
        break;
      }
      default:  // boxes and arrows
        for (int k = 0; k < 3; ++k) {
          const cv::Rect box(area.x + k * area.width / 3, area.y + Pick(random, 0, area.height / 2),
                             area.width / 4, area.height / 4);
          cv::rectangle(picture, box, ink, pen, cv::LINE_AA);
          cv::arrowedLine(picture, {box.x + box.width, box.y + box.height / 2},
                          {box.x + box.width * 4 / 3, box.y + box.height / 2}, ink, pen,
                          cv::LINE_AA);
        }
    }
  }
  DrawFrame(picture, w / 60, 120);
  return picture;
}

}  // namespace alidade
