// The inertial terms of the normal equations of bundle adjustment.
#pragma once

#include <array>
#include <vector>

#include "alidade/optimize/block_cholesky.h"
#include "alidade/optimize/bundle_motion.h"

namespace alidade {

struct BundleState;
struct Linearisation;

// What is constant between steps. Each state is one row of the reduced system after those of the
// free cameras, with the increments (velocity; bias of the accelerometer).
struct MotionLayout {
  struct Link {
    const BundleMotionLink* link;
    std::array<int, 4> rows;  // camera, state `from`; camera, state `to`; -1: fixed
    std::array<std::array<int, 4>, 4> blocks;  // index in `blocks` of (rows[a], rows[b]); -1: none
    Matrix9d whitening;                        // U with U' U = covariance⁻¹
  };
  Se3 T_camera_imu;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  std::vector<BundleMotionState> start;  // states before the first step
  std::vector<Link> links;
  std::vector<BlockPlace> blocks;  // below the diagonal, each once
  int first_row = 0;               // number of free cameras
};

// `slots`: row of each camera of the problem, -1: fixed. Throws Error (usage) if an index is out of
// range or a covariance is singular.
MotionLayout LayOutMotion(const BundleMotion& motion, const std::vector<int>& slots,
                          int free_cameras);

// Adds costs, gradients and Hessians at `state`.
void AddMotion(const MotionLayout& layout, const BundleState& state, Linearisation& result);

}  // namespace alidade
