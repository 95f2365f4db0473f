// Bundle adjustment: jointly optimizes camera poses and points on flat arrays. Levenberg–Marquardt
// on the Schur complement (Triggs et al. 2000, §6), ordered by landmark.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/optimize/bundle_motion.h"

namespace ALIDADE_API alidade {

struct BundleObservation {
  int camera = -1, point = -1;  // indices
  // u, v (undistorted), and u in the right image (NaN if there is none), pixels.
  Eigen::Vector3d pixel;
  double inv_sigma2 = 1;        // 1 / variance of u and v, 1/px²
  double inv_sigma2_right = 1;  // 1 / variance of the disparity u - u_right, 1/px²
  double trust = 1;  // 0 to 1, weight in the cost; does not change the observation's chi²
};

struct BundleProblem {
  Camera camera;                                // common to all images; its distortion is not used
  std::vector<Se3> T_camera_world;              // initial values and result
  std::vector<uint8_t> fixed;                   // one per camera; nonzero: held constant
  std::vector<Eigen::Vector3d> points;          // in the world frame; initial values and result
  std::vector<BundleObservation> observations;  // sorted by point
  BundleMotion motion;                          // of an inertial sensor; may be empty
};

struct BundleSettings {
  int max_iterations = 10;      // accepted or rejected Levenberg–Marquardt steps
  double huber_mono = 2.447;    // sqrt(5.991), standard deviations
  double huber_stereo = 2.796;  // sqrt(7.815)
  // Geman & McClure's loss ½ r² / (1 + r² / c²) instead of Huber's, c being the bounds above: what
  // lies far beyond c pulls no more at all (weight 1 / (1 + r² / c²)²), where Huber's pull stays.
  // For a start near the result: from afar good observations are let go, too.
  bool redescending = false;
  double min_relative_decrease = 1e-5;  // stops when a step lowers the cost by less
  // Damping, relative to the diagonal. For a whole map take 1e-6: where all of it is bent, hundreds
  // of cameras move together, each step weighed down by the damping of all of them.
  double initial_lambda = 1e-4;
  int sparse_above = 100;  // free cameras; above, the reduced system is factored sparse if faster
  void Check() const;      // throws Error naming the field that cannot be
};

struct BundleReport {
  double initial_cost = 0, final_cost = 0;  // ½ sum of weighted losses, unitless
  int iterations = 0;
  bool converged = false;  // stopped by the decrease, not by the iteration limit or `stop`
};

// Improves `problem` in place; the cost never rises. Points and cameras without usable observations
// are unchanged. Observations that are not finite, have zero trust, or whose point starts behind
// the camera are ignored. A point that a step would move behind one of its cameras is not moved in
// that step; a step in which the camera motion alone would cause that is rejected. Without a fixed
// camera the damping fixes the gauge. `stop` (may be null) is polled between iterations. The result
// does not depend on the number of threads. Throws Error (usage) on indices out of range.
BundleReport AdjustBundle(BundleProblem& problem, const BundleSettings& settings = {},
                          const std::atomic<bool>* stop = nullptr);

// Squared error of one observation in standard deviations (chi²); infinity behind the camera.
double ChiSquared(const Camera& camera, const Se3& T_camera_world, const Eigen::Vector3d& p_world,
                  const BundleObservation& observation);

}  // namespace alidade
