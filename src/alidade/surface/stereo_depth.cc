#include "alidade/surface/stereo_depth.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace alidade {
namespace {

constexpr int kWindow = 7;  // pixels
// Standard deviation of the blur before matching, pixels: with noise of 4 gray levels 10 % more
// pixels are matched, with the same error.
constexpr double kBlur = 1.2;
constexpr int kMostShare = 4;  // disparities up to this part of the width
constexpr float kUnits = 16;   // OpenCV's fixed point

}  // namespace

cv::Mat1f StereoDepth(const cv::Mat& left, const cv::Mat& right, const Camera& camera,
                      double nearest) {
  const double bf = camera.fx * camera.baseline;
  const int wanted = static_cast<int>(std::ceil(std::min(bf / nearest, 1e4) / 16)) * 16;
  const int count = std::clamp(wanted, 16, std::max(16, left.cols / kMostShare / 16 * 16));
  // Penalties as OpenCV recommends for the window; the other values are its defaults.
  const int area = kWindow * kWindow;
  const auto matcher = cv::StereoSGBM::create(0, count, kWindow, 8 * area, 32 * area, 1, 31, 10,
                                              100, 2, cv::StereoSGBM::MODE_SGBM_3WAY);
  cv::Mat smooth_left, smooth_right;
  cv::GaussianBlur(left, smooth_left, {}, kBlur);
  cv::GaussianBlur(right, smooth_right, {}, kBlur);
  cv::Mat disparity;  // CV_16S
  // A margin of the largest disparity, so that the left border is matched, too.
  cv::Mat wide_left, wide_right;
  cv::copyMakeBorder(smooth_left, wide_left, 0, 0, count, 0, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(smooth_right, wide_right, 0, 0, count, 0, cv::BORDER_REPLICATE);
  matcher->compute(wide_left, wide_right, disparity);
  cv::Mat1f depth(left.size(), 0.0f);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float d = disparity.at<int16_t>(y, x + count) / kUnits;
      if (d > 0 && d <= static_cast<float>(x)) depth(y, x) = static_cast<float>(bf) / d;
    }
  }
  return depth;
}

}  // namespace alidade
