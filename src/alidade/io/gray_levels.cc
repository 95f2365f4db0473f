#include "alidade/io/gray_levels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace alidade {
namespace {

constexpr double kLearnSeconds = 1;
constexpr double kTail = 0.005;  // share of the pixels outside either percentile
constexpr double kMargin = 0.1;  // of the distance of the percentiles
constexpr double kLevels = 65535;
constexpr double kFullRange = kLevels / 4;
constexpr double kLeastRange = 64;  // fewer levels are noise

}  // namespace

void GrayLevels::Learn(const cv::Mat& image) {
  std::vector<uint32_t> histogram(65536, 0);
  for (int y = 0; y < image.rows; ++y) {
    const auto* row = image.ptr<uint16_t>(y);
    for (int x = 0; x < image.cols; ++x) ++histogram[row[x]];
  }
  const auto tail = static_cast<uint64_t>(kTail * static_cast<double>(image.total()));
  size_t black = 0, white = histogram.size() - 1;
  for (uint64_t sum = histogram[black]; sum <= tail; sum += histogram[++black]) {
  }
  for (uint64_t sum = histogram[white]; sum <= tail; sum += histogram[--white]) {
  }
  const Range now{static_cast<double>(black), static_cast<double>(white)};
  percentiles_ = percentiles_ ? Range{std::min(percentiles_->black, now.black),
                                      std::max(percentiles_->white, now.white)}
                              : now;
  const double distance = percentiles_->white - percentiles_->black;
  if (distance >= kFullRange) {
    range_ = Range{0, kLevels};
    return;
  }
  const double margin = kMargin * distance + std::max(0.0, kLeastRange - distance) / 2;
  const double low = std::max(0.0, percentiles_->black - margin);
  range_ = Range{low, std::max(percentiles_->white + margin, low + kLeastRange)};
}

cv::Mat GrayLevels::To8Bit(const cv::Mat& image, double time) {
  if (image.type() != CV_16UC1) return image;
  if (!first_) first_ = time;
  if (!range_ || std::abs(time - *first_) < kLearnSeconds) Learn(image);
  const double scale = 255 / (range_->white - range_->black);
  cv::Mat gray;
  image.convertTo(gray, CV_8U, scale, -scale * range_->black);
  return gray;
}

cv::Mat GrayLevels::ColorTo8Bit(const cv::Mat& color) const {
  if (color.depth() != CV_16U || !range_) return color;
  const double scale = 255 / (range_->white - range_->black);
  cv::Mat color8;
  color.convertTo(color8, CV_8U, scale, -scale * range_->black);
  return color8;
}

}  // namespace alidade
