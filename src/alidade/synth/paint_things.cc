#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "alidade/synth/paint.h"

namespace alidade {
namespace {

int Pick(Random& random, int low, int high) {  // both included
  return low + static_cast<int>(random.Below(static_cast<uint32_t>(high - low + 1)));
}

cv::Point PickPoint(Random& random, cv::Size size) {
  return {Pick(random, 0, size.width - 1), Pick(random, 0, size.height - 1)};
}

// A tone at least `apart` from `other`.
double Contrasting(Random& random, double other, double apart = 50) {
  double tone;
  do {
    tone = random.Uniform(20, 235);
  } while (std::abs(tone - other) < apart);
  return tone;
}

std::string Word(Random& random, int letters) {
  static const char kVowels[] = "aeiou", kOthers[] = "bcdfghklmnprstvwz";
  std::string word;
  for (int i = 0; i < letters; ++i) {
    word += i % 2 == 0 ? kOthers[random.Below(17)] : kVowels[random.Below(5)];
  }
  return word;
}

// Print that fills a box: a line is `line` texels high.
void WriteText(Random& random, cv::Mat& picture, cv::Rect box, double line, double tone) {
  box &= cv::Rect({0, 0}, picture.size());
  if (box.area() <= 0) return;
  cv::Mat area = picture(box);
  const double scale = line / 34.0;
  const int stroke = std::max(1, static_cast<int>(std::lround(line / 12)));
  for (double y = line; y < box.height; y += line * 1.35) {
    double x = line * 0.3;
    while (x < box.width * 0.92) {
      const int letters = Pick(random, 2, 8);
      std::string word = Word(random, letters);
      if (random.Uniform() < 0.2) word[0] = static_cast<char>(word[0] - 'a' + 'A');
      if (x + letters * line * 0.5 > box.width) break;
      cv::putText(area, word, {static_cast<int>(x), static_cast<int>(y)}, cv::FONT_HERSHEY_SIMPLEX,
                  scale, cv::Scalar(tone), stroke, cv::LINE_AA);
      x += (letters + 0.8) * line * 0.52;
    }
    if (random.Uniform() < 0.1) y += line;  // end of a paragraph
  }
}

void DrawShape(Random& random, cv::Mat& picture, double smallest, double largest) {
  const cv::Point centre = PickPoint(random, picture.size());
  const int r = std::max(2, static_cast<int>(random.Uniform(smallest, largest)));
  const double tone = random.Uniform(15, 240), turn = random.Uniform(0, 360);
  switch (random.Below(4)) {
    case 0:
      cv::circle(picture, centre, r, tone, random.Uniform() < 0.6 ? -1 : std::max(2, r / 4),
                 cv::LINE_AA);
      break;
    case 1:
      cv::ellipse(picture, centre, {r, std::max(2, r / 3)}, turn, 0, 360, tone, -1, cv::LINE_AA);
      break;
    default: {
      const int corners = Pick(random, 3, 6);
      std::vector<cv::Point> polygon;
      for (int i = 0; i < corners; ++i) {
        const double angle = turn + 6.2832 * i / corners, radius = r * random.Uniform(0.6, 1.2);
        polygon.emplace_back(centre.x + static_cast<int>(radius * std::cos(angle)),
                             centre.y + static_cast<int>(radius * std::sin(angle)));
      }
      cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{polygon}, tone, cv::LINE_AA);
    }
  }
}

// Hills under a sky: what photographs on walls show. By day or night, gentle or rugged, from afar
// or near.
void DrawLandscape(Random& random, cv::Mat picture) {
  const cv::Size size = picture.size();
  const double zenith = random.Uniform(60, 235), horizon = random.Uniform(120, 240);
  for (int y = 0; y < size.height; ++y)
    picture.row(y) = zenith + (horizon - zenith) * y / size.height;
  for (int disc = Pick(random, 0, 2); disc > 0; --disc) {
    cv::circle(picture, {Pick(random, 0, size.width), Pick(random, 0, size.height / 2)},
               Pick(random, size.width / 24, size.width / 6), Contrasting(random, zenith, 40), -1,
               cv::LINE_AA);
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

void DrawFrame(cv::Mat& picture, int width, double tone) {
  cv::rectangle(picture, {0, 0, picture.cols, picture.rows}, tone, width);
  cv::rectangle(picture, {width, width, picture.cols - 2 * width, picture.rows - 2 * width},
                tone * 0.6, std::max(1, width / 4));
}

cv::Mat Blank(cv::Size size, double tone) { return cv::Mat(size, CV_8U, cv::Scalar(tone)); }

}  // namespace

cv::Mat PaintPoster(Random& random, cv::Size size) {
  const double ground = random.Uniform() < 0.6 ? random.Uniform(190, 240) : random.Uniform(25, 110);
  cv::Mat picture = Blank(size, ground);
  const int w = size.width, h = size.height, side = std::min(w, h);
  switch (random.Below(4)) {
    case 0:  // shapes over one another
      for (int i = 0; i < 16; ++i) DrawShape(random, picture, side * 0.05, side * 0.22);
      WriteText(random, picture, {w / 12, h * 3 / 4, w * 5 / 6, h / 5}, h / 14.0,
                Contrasting(random, ground, 90));
      break;
    case 1: {  // a photograph and a caption
      DrawLandscape(random, picture(cv::Rect(w / 16, h / 16, w - w / 8, h * 5 / 8)));
      WriteText(random, picture, {w / 12, h * 23 / 32, w * 5 / 6, h / 5}, h / 18.0,
                Contrasting(random, ground, 90));
      break;
    }
    case 2: {  // text and figures, as at a conference
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
        cv::rectangle(
            picture,
            {a.x, a.y, Pick(random, side / 30, side / 9), Pick(random, side / 30, side / 9)},
            ground + random.Uniform(-70, 50), -1);
      }
      for (int i = 0; i < 14; ++i) {
        cv::line(picture, PickPoint(random, size), PickPoint(random, size),
                 Contrasting(random, ground), std::max(1, side / 70), cv::LINE_AA);
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

cv::Mat PaintCarton(Random& random, cv::Size size) {
  cv::Mat1f card(size, static_cast<float>(random.Uniform(125, 165)));
  card += 4.0 * FractalNoise(random, size, size.width / 4.0, size.height / 4.0, 5, 0.6);
  cv::Mat picture = ToGrey(card);
  const int w = size.width, h = size.height;
  cv::rectangle(picture, {0, h * 2 / 5, w, h / 8}, 185, -1);  // tape
  const cv::Rect label(Pick(random, w / 20, w / 3), Pick(random, h / 20, h / 8), w / 2, h / 3);
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

cv::Mat PaintScreen(Random& random, cv::Size size) {
  cv::Mat picture = Blank(size, random.Uniform(40, 90));
  const int w = size.width, h = size.height;
  for (int i = 0; i < 4; ++i) {
    const cv::Rect window(Pick(random, 0, w / 2), Pick(random, 0, h / 2),
                          Pick(random, w / 4, w / 2), Pick(random, h / 4, h / 2));
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

cv::Mat PaintWindow(Random& random, cv::Size size) {
  cv::Mat picture = Blank(size, 240);
  const int w = size.width, h = size.height;
  for (int y = 0; y < h; ++y) picture.row(y) = 245 - 25.0 * y / h;
  for (int i = 0; i < 5; ++i) {  // houses with windows
    const cv::Rect house(Pick(random, -w / 10, w), Pick(random, h * 2 / 5, h * 7 / 10),
                         Pick(random, w / 6, w / 3), h);
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
      cv::circle(picture,
                 {foot.x + Pick(random, -w / 8, w / 8), h * 3 / 5 + Pick(random, -h / 7, h / 7)},
                 std::max(2, w / 50), random.Uniform(60, 150), -1, cv::LINE_AA);
    }
  }
  cv::line(picture, {w / 2, 0}, {w / 2, h}, 215, std::max(3, w / 25));
  cv::line(picture, {0, h / 3}, {w, h / 3}, 215, std::max(3, w / 30));
  DrawFrame(picture, w / 18, 205);
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
    cv::circle(picture, {x, h / 2}, Pick(random, h / 16, h / 7), random.Uniform(20, 235), -1,
               cv::LINE_AA);
  }
  return picture;
}

}  // namespace alidade
