// Number of RANSAC iterations.
#pragma once

#include <cmath>

namespace alidade {

// Number of samples of three matches until one of them is free of outliers with probability
// `confidence` (Fischler & Bolles 1981).
inline double SamplesNeeded(double inlier_share, double confidence) {
  const double good = inlier_share * inlier_share * inlier_share;
  if (good <= 0) return INFINITY;
  if (good >= 1) return 1;
  return std::log(1 - confidence) / std::log1p(-good);
}

}  // namespace alidade
