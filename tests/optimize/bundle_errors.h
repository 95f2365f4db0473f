// What bundle adjustment leaves of a problem: its cost, and how far two results are apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>

#include "problems/bundle_problem.h"

namespace alidade {

// ½ sum of Huber losses, implemented independently.
inline double CostOf(const BundleProblem& problem, const BundleSettings& settings = {}) {
  double cost = 0;
  for (const BundleObservation& o : problem.observations) {
    const double chi2 =
        ChiSquared(problem.camera, problem.T_camera_world[o.camera], problem.points[o.point], o);
    const double bound = std::isfinite(o.pixel.z()) ? settings.huber_stereo : settings.huber_mono;
    const double root = std::sqrt(chi2);
    cost += o.trust * (root <= bound ? 0.5 * chi2 : bound * (root - 0.5 * bound));
  }
  return cost;
}

inline bool SameBits(const BundleProblem& a, const BundleProblem& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return x.size() == y.size() &&
           (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0);
  };
  return equal(a.T_camera_world, b.T_camera_world) && equal(a.points, b.points);
}

inline double LargestPointError(const BundleProblem& a, const BundleProblem& b) {
  double worst = 0;
  for (size_t i = 0; i < a.points.size(); ++i) {
    worst = std::max(worst, (a.points[i] - b.points[i]).norm());
  }
  return worst;
}

inline double LargestCameraError(const BundleProblem& a, const BundleProblem& b) {
  double worst = 0;
  for (size_t i = 0; i < a.T_camera_world.size(); ++i) {
    const Se3 &T = a.T_camera_world[i], &U = b.T_camera_world[i];
    worst = std::max(worst, (T.Inverse().t - U.Inverse().t).norm());
  }
  return worst;
}

}  // namespace alidade
