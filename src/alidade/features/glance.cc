#include "alidade/features/glance.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/base/part_times.h"
#include "alidade/features/shrink.h"

namespace alidade {
namespace {

Eigen::Vector2d GradientAt(const cv::Mat& image, int x, int y) {
  return {0.5 * (image.at<float>(y, x + 1) - image.at<float>(y, x - 1)),
          0.5 * (image.at<float>(y + 1, x) - image.at<float>(y - 1, x))};
}

// Mean and covariance of cell positions.
struct Places {
  int count = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  void Add(const Eigen::Vector2d& place) {
    ++count;
    sum += place;
    squares += place * place.transpose();
  }
  double Area() const {
    if (count < 2) return 0;
    const Eigen::Vector2d mean = sum / count;
    return std::sqrt(std::max(0.0, (squares / count - mean * mean.transpose()).determinant()));
  }
};

}  // namespace

cv::Mat Glance(const cv::Mat& image) {
  const PartTimer timer(FramePart::kGlance);
  constexpr int kWidth = 240;
  cv::Mat small, smooth;
  const int width = std::min(kWidth, image.cols);
  const int height = std::max(
      1, static_cast<int>(std::lround(static_cast<double>(image.rows) * width / image.cols)));
  small = ShrinkArea(image, {width, height});
  small.convertTo(smooth, CV_32F);
  cv::GaussianBlur(smooth, smooth, {3, 3}, 0);
  return smooth;
}

double StillShare(const cv::Mat& a, const cv::Mat& b, const GlanceSettings& settings) {
  if (a.empty() || a.size() != b.size()) return 0;
  Eigen::Matrix2d all = Eigen::Matrix2d::Zero(), still = Eigen::Matrix2d::Zero();
  Places everywhere, at_rest;
  const double least2 = settings.min_gradient * settings.min_gradient;
  const double same2 = settings.same * settings.same;
  for (int top = 1; top + settings.cell < a.rows; top += settings.cell) {
    for (int left = 1; left + settings.cell < a.cols; left += settings.cell) {
      int pixels = 0, stayed = 0;
      Eigen::Matrix2d T = Eigen::Matrix2d::Zero();
      for (int y = top; y < top + settings.cell; ++y) {
        for (int x = left; x < left + settings.cell; ++x) {
          const Eigen::Vector2d before = GradientAt(a, x, y);
          const double strength2 = before.squaredNorm();
          if (!(strength2 >= least2)) continue;  // or left out: not a number
          ++pixels;
          stayed += (GradientAt(b, x, y) - before).squaredNorm() <= same2 * strength2;
          T += before * before.transpose() / strength2;
        }
      }
      if (pixels < settings.min_pixels) continue;
      T /= pixels;
      all += T;
      everywhere.Add({left, top});
      if (stayed < settings.still_share * pixels) continue;
      still += T;
      at_rest.Add({left, top});
    }
  }
  if (!(all.determinant() > 1e-9 * all.trace() * all.trace())) return 0;
  if (at_rest.Area() < settings.min_area * everywhere.Area()) return 0;
  // Smallest generalized eigenvalue of still d = λ all d.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> solver(still, all);
  return std::clamp(solver.eigenvalues().minCoeff(), 0.0, 1.0);
}

}  // namespace alidade
