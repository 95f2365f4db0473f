// Bundle adjustment with intrinsics: estimates focal length, radial distortion, principal point and
// rolling-shutter readout time from images only (self-calibration).
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <optional>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// Camera with square pixels. A point at (x, y, 1) is observed at
//   (u, v) = centre + f (1 + k1 r² + k2 r⁴) (x, y),  r² = x² + y²  (Brown's radial terms).
struct RadialLens {
  double focal = 0;                                  // pixels
  double k1 = 0, k2 = 0;                             // unitless
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // pixels
  // Rolling-shutter readout time, seconds from the first to the last column and row (see
  // Camera::readout).
  Eigen::Vector2d readout = Eigen::Vector2d::Zero();
};

struct LensObservation {
  int camera = -1, point = -1;  // indices within the window
  Eigen::Vector2d pixel;        // raw (distorted) position in the image
  double inv_sigma2 = 1;        // 1 / variance up to a common factor, 1/px²
  // Readout position: seconds relative to the middle of the image per second of readout, by column
  // and row.
  Eigen::Vector2d read = Eigen::Vector2d::Zero();
};

// A part of a recording whose views share points with each other but not with other windows. Each
// window has its own gauge.
struct LensWindow {
  std::vector<Se3> T_camera_world;  // initial values and result
  // Motion of each camera, units of its T_camera_world per second (see Frame::motion). Empty: none
  // moved during the readout.
  std::vector<Vector6d> motions;
  std::vector<Eigen::Vector3d> points;  // in the window's world frame; initial values and result
  std::vector<LensObservation> observations;  // sorted by point
};

struct LensAdjustmentSettings {
  int max_iterations = 30;              // accepted or rejected Levenberg–Marquardt steps
  double min_relative_decrease = 1e-6;  // stops when a step lowers the cost by less, …
  double min_lens_step = 1e-5;          // … and moves log focal, k1 and k2 by less each
  // What is known beforehand, as standard deviations about the start of the focal length's
  // logarithm and about no distortion. 0.35: 66 degrees may be 49 to 85 (one sigma).
  double focal_sigma = 0.35;
  double k1_sigma = 0.3;
  double k2_sigma = 0.1;    // 0: k2 stays as it starts; so k1
  double centre_sigma = 0;  // pixels, of either coordinate; 0: the centre stays as it starts
  // Seconds, about none, across and down; 0: that readout stays as it starts.
  Eigen::Vector2d readout_sigma = Eigen::Vector2d::Zero();
  bool hold_focal = false;  // the focal length stays as it starts, whatever its sigma
  // About which the centre is believed to be, pixels; else its start.
  std::optional<Eigen::Vector2d> centre = {};
  // Factor on the standard deviations that residuals give: those assume independent noise, and
  // keypoints that move along edges, blur and rolling shutter are correlated. Used in the prior
  // and the covariance (docs/development/decisions/0005-offline-self-calibration.md).
  double inflation = 3.0;
  // Bound c of Geman & McClure's loss ½ r² / (1 + r² / c²), in standard deviations of the noise
  // seen: matches that are no points pull no more. The noise is the median of all residuals'.
  double bound = 3.0;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

struct LensAdjustment {
  static constexpr int kParameters = 7;  // log focal, k1, k2, centre, readout
  using Parameters = Eigen::Matrix<double, kParameters, 1>;
  RadialLens lens;
  // Covariance of the parameters with poses and points marginalized, prior included; 0 for fixed
  // parameters. From the measured noise times inflation². With three or more windows the sandwich
  // estimator for clusters is used where it is larger: H⁻¹ (Σ g g') H⁻¹ with each window's gradient
  // g (Liang & Zeger 1986). It accounts for all errors that vary between windows.
  Eigen::Matrix<double, kParameters, kParameters> covariance =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
  double noise = 0;      // standard deviation of a residual, in units of sqrt(1 / inv_sigma2)
  int observations = 0;  // number of observations used
  int iterations = 0;
  bool converged = false;
};

// Refines `windows` in place together with the lens, starting at `start`. Levenberg–Marquardt;
// eliminates the points (Triggs et al. 2000, §6), then the poses of each window, which leaves a
// small system for the lens. Motions that do not constrain the focal length (no rotation, straight
// ahead, a fronto-parallel plane) leave it at the prior, which the covariance shows. `stop` (may be
// null) is polled between iterations. The result does not depend on the number of threads. Throws
// Error (usage) on indices out of range.
LensAdjustment AdjustLens(std::vector<LensWindow>& windows, const RadialLens& start,
                          const LensAdjustmentSettings& settings = {},
                          const std::atomic<bool>* stop = nullptr);

}  // namespace alidade
