// Images with structure at all scales: opaque shapes with power-law sizes that occlude each other
// ("dead leaves"), slightly blurred. Deterministic for a given seed on all machines.
#pragma once

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/base/random.h"

namespace alidade {

inline cv::Mat MakeTexture(int width, int height, uint64_t seed) {
  Random random(seed);
  cv::Mat picture(height, width, CV_8UC1, cv::Scalar(128));
  const int shapes = width * height / 200;
  for (int i = 0; i < shapes; ++i) {
    const double u = random.Uniform(), low = 4, high = 120;  // radius, density ~ r^-3
    const double r = 1 / std::sqrt((1 - u) / (low * low) + u / (high * high));
    const double x = random.Uniform(0, width), y = random.Uniform(0, height);
    const double turn = random.Uniform(0, 2 * std::numbers::pi);
    const int corners = 3 + static_cast<int>(random.Below(4));
    std::vector<cv::Point> outline;  // in 1/16 pixels
    for (int k = 0; k < corners; ++k) {
      const double angle = turn + 2 * std::numbers::pi * (k + random.Uniform(-0.3, 0.3)) / corners;
      outline.emplace_back(static_cast<int>(std::lround(16 * (x + r * std::cos(angle)))),
                           static_cast<int>(std::lround(16 * (y + r * std::sin(angle)))));
    }
    cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{outline},
                 cv::Scalar(random.Uniform(20, 235)), cv::LINE_AA, 4);
  }
  cv::GaussianBlur(picture, picture, cv::Size(5, 5), 0.8);
  return picture;
}

inline void AddNoise(cv::Mat& image, double sigma, uint64_t seed) {
  Random random(seed);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<uint8_t>(y, x) =
          cv::saturate_cast<uint8_t>(image.at<uint8_t>(y, x) + sigma * random.Gaussian());
    }
  }
}

}  // namespace alidade
