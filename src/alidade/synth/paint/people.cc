#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "alidade/synth/paint/paint.h"

namespace alidade {

cv::Mat PaintHead(Random& random, cv::Size size) {
  const double skin = random.Uniform(95, 190), hair = random.Uniform(20, 110);
  cv::Mat1f picture(size, static_cast<float>(hair));
  const int w = size.width, h = size.height, cx = w / 2;
  picture += 12.0 * FractalNoise(random, size, w / 60.0, h / 4.0, 3, 0.7);
  // The face is in the middle; v of the ball runs from the crown to below the chin.
  cv::ellipse(picture, {cx, h * 11 / 20}, {w * 9 / 50, h * 9 / 40}, 0, 0, 360, skin, -1,
              cv::LINE_AA);
  cv::rectangle(picture, {0, h * 31 / 40, w, h / 4}, skin * 0.9, -1);
  for (int side = -1; side <= 1; side += 2) {
    const cv::Point eye(cx + side * w * 7 / 100, h / 2);
    cv::ellipse(picture, eye, {w / 36, h / 50}, 0, 0, 360, 235, -1, cv::LINE_AA);
    cv::circle(picture, eye, std::max(2, w / 80), 25, -1, cv::LINE_AA);
    cv::line(picture, {eye.x - w / 28, eye.y - h / 20}, {eye.x + w / 28, eye.y - h / 18}, hair,
             std::max(2, h / 60), cv::LINE_AA);
    cv::ellipse(picture, {cx + side * w / 4, h * 27 / 50}, {w / 50, h / 18}, 0, 0, 360, skin * 0.85,
                -1, cv::LINE_AA);
  }
  cv::line(picture, {cx, h / 2}, {cx + w / 90, h * 59 / 100}, skin * 0.75, std::max(2, w / 60),
           cv::LINE_AA);
  cv::ellipse(picture, {cx, h * 67 / 100}, {w / 22, h / 70}, 0, 0, 360, skin * 0.5, -1,
              cv::LINE_AA);
  return ToGrey(picture);
}

ShirtStyle PickShirt(Random& random) {
  ShirtStyle style;
  style.tone = random.Uniform(50, 205);
  style.other =
      style.tone > 128 ? style.tone - random.Uniform(50, 90) : style.tone + random.Uniform(50, 90);
  style.pattern = static_cast<int>(random.Below(4));
  return style;
}

cv::Mat PaintShirt(Random& random, cv::Size size, const ShirtStyle& style, bool sleeve) {
  const int w = size.width, h = size.height;
  cv::Mat1f picture(size, static_cast<float>(style.tone));
  const double rows = sleeve ? 7 : 11, columns = sleeve ? 8 : 24;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const bool row = std::fmod(y * rows / h, 1.0) < 0.4,
                 column = std::fmod(x * columns / w, 1.0) < 0.4;
      if ((style.pattern == 0 && row) || (style.pattern == 1 && row != column))
        picture(y, x) = static_cast<float>(style.other);
    }
  }
  if (style.pattern >= 2 && !sleeve) {  // print on the chest and on the back
    for (const int cx : {w / 2, 0, w}) {
      if (style.pattern == 2) {
        cv::circle(picture, {cx, h * 2 / 5}, h / 6, style.other, -1, cv::LINE_AA);
        cv::circle(picture, {cx, h * 2 / 5}, h / 10, style.tone, std::max(2, h / 40), cv::LINE_AA);
      } else {
        for (int i = 0; i < 4; ++i) {
          cv::rectangle(picture, {cx - w / 10, h / 5 + i * h / 9, w / 5 - i * w / 60, h / 20},
                        style.other, -1);
        }
      }
    }
  }
  picture += 9.0 * FractalNoise(random, size, w / 12.0, h / 3.0, 4, 0.6);  // folds
  return ToGrey(picture);
}

cv::Mat PaintTrousers(Random& random, cv::Size size) {
  cv::Mat1f picture(size, static_cast<float>(random.Uniform(35, 130)));
  const int w = size.width, h = size.height;
  picture += 8.0 * FractalNoise(random, size, w / 5.0, h / 9.0, 5, 0.65);
  for (const int x : {w / 4, w * 3 / 4}) cv::line(picture, {x, 0}, {x, h}, 20, std::max(1, w / 80));
  return ToGrey(picture);
}

}  // namespace alidade
