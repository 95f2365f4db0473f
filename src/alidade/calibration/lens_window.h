// Contribution of one window to the intrinsics: its normal equations with poses and points
// eliminated.
#pragma once

#include <Eigen/Cholesky>
#include <utility>
#include <vector>

#include "alidade/calibration/lens_adjustment.h"

namespace alidade {

using LensMatrix = Eigen::Matrix<double, LensAdjustment::kParameters, LensAdjustment::kParameters>;
using LensVector = LensAdjustment::Parameters;

// Geman & McClure's loss; the bound is in units of `noise`.
struct LensLoss {
  double noise = 1, bound = 3;
  // `chi2` is in units of the assumed variance.
  double Weight(double chi2) const {
    const double q = chi2 / (noise * noise * bound * bound);
    return 1 / ((1 + q) * (1 + q));
  }
  double Cost(double chi2) const {
    return 0.5 * chi2 / (1 + chi2 / (noise * noise * bound * bound));
  }
};

// Normal equations of one window at the current estimate, points eliminated.
struct WindowSystem {
  Eigen::MatrixXd H;             // poses, lower triangle
  Eigen::MatrixXd lens_by_pose;  // lens × poses
  Eigen::VectorXd g;             // gradient of the poses: J' W r
  LensMatrix lens = LensMatrix::Zero();
  LensVector g_lens = LensVector::Zero();
  int observations = 0;
  // Quantities kept from eliminating a point, to compute its step from those of poses and lens.
  struct Point {
    Eigen::Matrix3d inverse;
    Eigen::Vector3d g;
    Eigen::Matrix<double, LensAdjustment::kParameters, 3> by_lens;  // lens × point
    std::vector<std::pair<int, Eigen::Matrix<double, 6, 3>>> by_camera;
  };
  // One per point of the window; empty by_camera: the point is not moved.
  std::vector<Point> points;
};

// Linearizes at the given lens and the window's poses and points. `damping` is the
// Levenberg–Marquardt damping of the points.
WindowSystem SystemOf(const LensWindow& window, const RadialLens& lens, const LensLoss& loss,
                      double damping);

// Normal equations of the lens alone, poses also eliminated.
struct LensSystem {
  Eigen::LDLT<Eigen::MatrixXd> poses;
  LensMatrix H;
  LensVector g;
};

LensSystem LensAlone(const WindowSystem& system, double damping);

// Moves poses and points of the window according to a step of the lens.
void MoveWindow(const WindowSystem& system, const LensSystem& alone, const LensVector& lens_step,
                LensWindow& window);

// chi² of each observation in units of the assumed variance, in order; infinity if the point does
// not project.
std::vector<double> ChiSquaredOf(const LensWindow& window, const RadialLens& lens);

}  // namespace alidade
