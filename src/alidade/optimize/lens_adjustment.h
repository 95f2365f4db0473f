// Bundle adjustment with the camera's lens among the unknowns: focal length and radial distortion
// are found from nothing but what a moving camera saw (self-calibration).
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <optional>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// Square pixels: a point at (x, y, 1) is seen at
//   (u, v) = centre + f (1 + k1 r² + k2 r⁴) (x, y),  r² = x² + y²  (Brown's radial terms).
struct RadialLens {
  double focal = 0;                                  // pixels
  double k1 = 0, k2 = 0;                             // unitless
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // pixels
  // Rolling shutter: seconds from the first to the last column, and row (see Camera::readout).
  Eigen::Vector2d readout = Eigen::Vector2d::Zero();
};

struct LensObservation {
  int camera = -1, point = -1;  // indices within the window
  Eigen::Vector2d pixel;        // as in the image, distortion and all
  double inv_sigma2 = 1;        // 1 / variance, up to a factor that all have in common; 1/px²
  // Where in the image's reading it was taken: seconds after the middle, per second of readout.
  Eigen::Vector2d read = Eigen::Vector2d::Zero();
};

// Views that share points with each other, but none with those of other windows: a stretch of a
// recording. Each has a gauge of its own.
struct LensWindow {
  std::vector<Se3> T_camera_world;  // start, and result
  // Of each camera, units of its T_camera_world per second (see Frame::motion); empty: none moved.
  std::vector<Vector6d> motions;
  std::vector<Eigen::Vector3d> points;        // in the window's world; start, and result
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
  // Of the parameters, all else unknown; the prior is in it. What is held has 0. By the noise
  // seen, times inflation²; or, of three windows and more, by what the windows differ where that is
  // more: H⁻¹ (Σ g g') H⁻¹ with each window's own gradient g (sandwich estimator for clusters:
  // Liang & Zeger 1986), which knows of all errors that change from window to window.
  Eigen::Matrix<double, kParameters, kParameters> covariance =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
  double noise = 0;      // of a residual, in the units of sqrt(1 / inv_sigma2)
  int observations = 0;  // that had a say
  int iterations = 0;
  bool converged = false;
};

// Improves `windows` and `start` together by Levenberg–Marquardt: points are eliminated first
// (Triggs et al. 2000, §6), then each window's poses, which leaves few equations for the lens.
// Motions that tell nothing of the focal length (no turning, straight ahead, a flat scene seen
// head-on) leave it to the prior: the covariance says so. The result is the same with any number of
// threads. Throws Error on indices that aren't there.
LensAdjustment AdjustLens(std::vector<LensWindow>& windows, const RadialLens& start,
                          const LensAdjustmentSettings& settings = {},
                          const std::atomic<bool>* stop = nullptr);

}  // namespace alidade
