#include "alidade/synth/paint/draw.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace alidade {
namespace {

std::string Word(Random& random, int letters) {
  static const char kVowels[] = "aeiou", kOthers[] = "bcdfghklmnprstvwz";
  std::string word;
  for (int i = 0; i < letters; ++i) {
    word += i % 2 == 0 ? kOthers[random.Below(17)] : kVowels[random.Below(5)];
  }
  return word;
}

}  // namespace

int Pick(Random& random, int low, int high) {
  return low + static_cast<int>(random.Below(static_cast<uint32_t>(high - low + 1)));
}

cv::Point PickPoint(Random& random, cv::Size size) {
  return {Pick(random, 0, size.width - 1), Pick(random, 0, size.height - 1)};
}

double Contrasting(Random& random, double other, double apart) {
  double tone;
  do {
    tone = random.Uniform(20, 235);
  } while (std::abs(tone - other) < apart);
  return tone;
}

cv::Mat Blank(cv::Size size, double tone) { return cv::Mat(size, CV_8U, cv::Scalar(tone)); }

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

void DrawFrame(cv::Mat& picture, int width, double tone) {
  cv::rectangle(picture, {0, 0, picture.cols, picture.rows}, tone, width);
  cv::rectangle(picture, {width, width, picture.cols - 2 * width, picture.rows - 2 * width},
                tone * 0.6, std::max(1, width / 4));
}

}  // namespace alidade
