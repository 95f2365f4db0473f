// A bundle problem in the order the solver walks it: point by point, each with the free cameras
// that see it in ascending order, then the fixed ones. Observations that cannot be used are left
// out here, once.
#pragma once

#include <vector>

#include "alidade/optimize/bundle_adjustment.h"
#include "alidade/optimize/reprojection.h"

namespace alidade {

struct BundleSighting {
  int camera;               // index in the problem
  int slot;                 // index among the free cameras, -1: fixed
  double u, v, right;       // pixels; right = 0 without
  double weight, weight_r;  // 1/px²; weight_r = 0 without
  double huber;             // standard deviations; infinite where the loss is another
  double inv_c2;            // of Geman & McClure's loss, 1 / variances; 0: Huber's
  double trust;             // above 0, up to 1
};

struct BundlePoint {
  int index;  // in the problem
  int begin, free_end,
      end;       // sightings: [begin, free_end) by free cameras, [free_end, end) by fixed ones
  int coupling;  // sum of (free_end - begin) over the points before
};

struct BundleLayout {
  Intrinsics intrinsics;
  std::vector<int> free_cameras;    // index in the problem, by slot; only those that see something
  std::vector<BundlePoint> points;  // only those that are seen
  std::vector<BundleSighting> sightings;
  std::vector<int>
      chunks;         // bounds of runs of points with about as much work; set by the problem alone
  int couplings = 0;  // sightings by free cameras

  int chunk_count() const { return static_cast<int>(chunks.size()) - 1; }
};

// Throws Error when an index is out of range.
BundleLayout LayOut(const BundleProblem& problem, const BundleSettings& settings);

}  // namespace alidade
