// A bundle problem in the solver's order: point by point, with the free cameras that observe it in
// ascending order, then the fixed ones. Unusable observations are removed here.
#pragma once

#include <vector>

#include "alidade/optimize/bundle_adjustment.h"
#include "alidade/optimize/bundle_motion_terms.h"
#include "alidade/optimize/reprojection.h"

namespace alidade {

struct BundleSighting {
  int camera;               // index in the problem
  int slot;                 // index among the free cameras; -1: fixed
  double u, v, right;       // pixels; right = 0 if there is none
  double weight, weight_r;  // 1/px²; weight_r = 0 if there is no right
  double huber;             // standard deviations; infinite if the loss is not Huber's
  double inv_c2;            // Geman & McClure's 1 / c², in 1 / variance; 0: Huber's loss
  double trust;             // in (0, 1]
};

struct BundlePoint {
  int index;  // in the problem
  // Sightings: [begin, free_end) by free cameras, [free_end, end) by fixed ones.
  int begin, free_end, end;
  int coupling;  // number of sightings by free cameras of all preceding points
};

struct BundleLayout {
  Intrinsics intrinsics;
  std::vector<int> free_cameras;    // index in the problem, by slot; only cameras with sightings
  std::vector<BundlePoint> points;  // only points with sightings
  std::vector<BundleSighting> sightings;
  // Bounds of runs of points with about equal work; a function of the problem only.
  std::vector<int> chunks;
  int couplings = 0;  // number of sightings by free cameras
  MotionLayout motion;

  // Block rows of the reduced system.
  int rows() const { return static_cast<int>(free_cameras.size() + motion.start.size()); }
  int chunk_count() const { return static_cast<int>(chunks.size()) - 1; }
};

// Throws Error (usage) if an index is out of range.
BundleLayout LayOut(const BundleProblem& problem, const BundleSettings& settings);

}  // namespace alidade
