// How often RANSAC has to draw.
#pragma once

#include <cmath>

namespace alidade {

// Samples of three until one is free of outliers with this confidence (Fischler & Bolles 1981).
inline double SamplesNeeded(double inlier_share, double confidence) {
  const double good = inlier_share * inlier_share * inlier_share;
  if (good <= 0) return INFINITY;
  if (good >= 1) return 1;
  return std::log(1 - confidence) / std::log1p(-good);
}

}  // namespace alidade
