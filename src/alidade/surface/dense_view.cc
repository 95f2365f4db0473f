#include "alidade/surface/dense_view.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace alidade {
namespace {

// Share of the depth, as for the depth of keypoints (features/depth.cc): slanted surfaces stay
// below.
constexpr float kStep = 0.05f;

}  // namespace

double RangeAt(double inverse_sigma, double sigma) {
  return inverse_sigma > 0 ? std::sqrt(sigma / inverse_sigma) : INFINITY;
}

cv::Mat1f WithoutSteps(const cv::Mat1f& depth) {
  cv::Mat1f known = depth.clone(), nearest, farthest;
  known.setTo(std::numeric_limits<float>::max(), depth <= 0);
  cv::erode(known, nearest, {});  // the least of 3 x 3
  cv::dilate(depth, farthest, {});
  cv::Mat1f kept(depth.size(), 0.0f);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth(y, x), step = kStep * z;
      if (z > 0 && farthest(y, x) - z <= step && z - nearest(y, x) <= step) kept(y, x) = z;
    }
  }
  return kept;
}

}  // namespace alidade
