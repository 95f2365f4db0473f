#include "alidade/surface/dense_view.h"

#include <algorithm>
#include <cmath>

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
  cv::Mat1f kept(depth.size(), 0.0f);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth(y, x);
      if (!(z > 0)) continue;
      bool step = false;
      for (int v = std::max(0, y - 1); v <= std::min(depth.rows - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(depth.cols - 1, x + 1); ++u) {
          const float other = depth(v, u);
          step = step || (other > 0 && std::abs(other - z) > kStep * z);
        }
      }
      if (!step) kept(y, x) = z;
    }
  }
  return kept;
}

}  // namespace alidade
