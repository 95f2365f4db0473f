// Bundle adjustment: camera poses and points that agree best with what was seen. Flat arrays, no
// map. Levenberg–Marquardt on the Schur complement (Triggs et al. 2000, §6), landmark-major.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

struct BundleObservation {
  int camera = -1, point = -1;  // indices
  Eigen::Vector3d
      pixel;  // u, v (undistorted) and u in the right image (NaN when there is none), pixels
  double inv_sigma2 = 1;        // 1 / variance of u and v, 1/px²
  double inv_sigma2_right = 1;  // the same of the disparity u - u_right, 1/px²
  double trust = 1;             // 0…1: its say in the result; its chi² does not change with it
};

struct BundleProblem {
  Camera camera;                        // one camera took all pictures; its distortion is not used
  std::vector<Se3> T_camera_world;      // start, and result
  std::vector<uint8_t> fixed;           // one per camera: nonzero = held where it is
  std::vector<Eigen::Vector3d> points;  // in the world; start, and result
  std::vector<BundleObservation> observations;  // sorted by point
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
  double initial_cost = 0, final_cost = 0;  // ½ sum of losses by trust, unitless
  int iterations = 0;
  bool converged = false;  // stopped by the decrease, not by the count or `stop`
};

// Improves `problem` in place; its cost never rises. Points and cameras that nothing usable was
// seen of stay as they are. Observations that are not numbers, not trusted at all, or whose point
// starts behind the camera, are left out for good. A point whose step would take it behind one of
// its cameras stays where it was in that step; a step in which the cameras alone would do that is
// rejected. Without a fixed camera the damping holds the gauge. `stop` (may be null) is looked at
// between iterations. The result is the same with any number of threads. Throws Error on indices
// that aren't there.
BundleReport AdjustBundle(BundleProblem& problem, const BundleSettings& settings = {},
                          const std::atomic<bool>* stop = nullptr);

// Squared error of one observation in standard deviations (chi²); infinity behind the camera.
double ChiSquared(const Camera& camera, const Se3& T_camera_world, const Eigen::Vector3d& p_world,
                  const BundleObservation& observation);

}  // namespace alidade
