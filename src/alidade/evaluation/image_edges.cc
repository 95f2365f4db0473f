#include "alidade/evaluation/image_edges.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace alidade {
namespace {

// Offset of the neighbor nearest to the gradient's direction.
cv::Point StepAlong(float gx, float gy) {
  constexpr float kTan22 = 0.41421356f;  // tan(22.5°)
  const float ax = std::abs(gx), ay = std::abs(gy);
  if (ay <= kTan22 * ax) return {1, 0};
  if (ax <= kTan22 * ay) return {0, 1};
  return gx * gy > 0 ? cv::Point(1, 1) : cv::Point(1, -1);
}

}  // namespace

ImageEdges FindImageEdges(const cv::Mat& image, double min_gradient) {
  cv::Mat1f gx, gy, magnitude;
  cv::Scharr(image, gx, CV_32F, 1, 0, 1.0 / 32);
  cv::Scharr(image, gy, CV_32F, 0, 1, 1.0 / 32);
  cv::magnitude(gx, gy, magnitude);
  ImageEdges edges;
  edges.gradient = magnitude >= min_gradient;
  edges.edge = cv::Mat1b::zeros(image.size());
  for (int y = 1; y + 1 < image.rows; ++y) {
    for (int x = 1; x + 1 < image.cols; ++x) {
      if (edges.gradient(y, x) == 0) continue;
      const cv::Point here(x, y), step = StepAlong(gx(here), gy(here));
      const float m = magnitude(here);
      // of two equal neighbors, one is the edge
      if (m > magnitude(here - step) && m >= magnitude(here + step)) edges.edge(here) = 255;
    }
  }
  return edges;
}

}  // namespace alidade
