// What one window of pictures says of their lens: its normal equations, all else eliminated.
#pragma once

#include <Eigen/Cholesky>
#include <utility>
#include <vector>

#include "alidade/optimize/lens_adjustment.h"

namespace alidade {

using LensMatrix = Eigen::Matrix<double, LensAdjustment::kParameters, LensAdjustment::kParameters>;
using LensVector = LensAdjustment::Parameters;

// Geman & McClure's loss, its bound in units of the noise there is.
struct LensLoss {
  double noise = 1, bound = 3;
  // chi2 in units of the assumed variance.
  double Weight(double chi2) const {
    const double q = chi2 / (noise * noise * bound * bound);
    return 1 / ((1 + q) * (1 + q));
  }
  double Cost(double chi2) const {
    return 0.5 * chi2 / (1 + chi2 / (noise * noise * bound * bound));
  }
};

// Normal equations of one window at one place, points eliminated.
struct WindowSystem {
  Eigen::MatrixXd H;             // poses, lower triangle
  Eigen::MatrixXd lens_by_pose;  // lens × poses
  Eigen::VectorXd g;             // of the poses: J' W r
  LensMatrix lens = LensMatrix::Zero();
  LensVector g_lens = LensVector::Zero();
  int observations = 0;
  // What eliminating left of each point, to find its step from those of poses and lens.
  struct Point {
    Eigen::Matrix3d inverse;
    Eigen::Vector3d g;
    Eigen::Matrix<double, LensAdjustment::kParameters, 3> by_lens;  // lens × point
    std::vector<std::pair<int, Eigen::Matrix<double, 6, 3>>> by_camera;
  };
  std::vector<Point> points;  // one for each of the window's; empty by_camera: it stays
};

// Linearised at a lens, the window's poses and points; each point damped by Levenberg–Marquardt.
WindowSystem SystemOf(const LensWindow& window, const RadialLens& lens, const LensLoss& loss,
                      double damping);

// The poses eliminated, too: what the window says of the lens alone.
struct LensSystem {
  Eigen::LDLT<Eigen::MatrixXd> poses;
  LensMatrix H;
  LensVector g;
};

LensSystem LensAlone(const WindowSystem& system, double damping);

// Poses and points follow a step of the lens.
void MoveWindow(const WindowSystem& system, const LensSystem& alone, const LensVector& lens_step,
                LensWindow& window);

// chi² of each observation in units of the assumed variance, in order; infinity where it is not
// seen.
std::vector<double> ChiSquaredOf(const LensWindow& window, const RadialLens& lens);

}  // namespace alidade
