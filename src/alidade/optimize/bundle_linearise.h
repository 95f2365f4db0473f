// Normal equations of bundle adjustment before elimination.
//
// A camera is stored as rotation R and center c, and observes a point at p = R (X - c). A step
// rotates the camera about its center, in world axes: p(ρ, θ) = R Exp(θ) (X - c + ρ). With Y = X -
// c and B = dr/dX, the camera's Jacobian is B [I, -[Y]x], so one symmetric matrix N = B' W B gives
// all blocks of J' W J:
//   point–point N,   camera–point G N,   camera–camera G N G',   G = [I; [Y]x].
#pragma once

#include <array>
#include <vector>

#include "alidade/optimize/bundle_layout.h"
#include "alidade/optimize/double2.h"

namespace alidade {

struct BundleCamera {
  Eigen::Matrix3d R;       // R_camera_world
  Eigen::Vector3d centre;  // in the world frame
};

struct BundleState {
  std::vector<BundleCamera> cameras;        // one per camera of the problem
  std::vector<Eigen::Vector3d> points;      // in the layout's order
  std::vector<BundleMotionState> motion{};  // of the inertial sensor
};

BundleState StartOf(const BundleProblem& problem, const BundleLayout& layout);

// Symmetric 3x3: xx, xy, xz, yy, yz, zz.
using Symmetric3 = std::array<double, 6>;

struct Coupling {  // between a free camera and a point
  Symmetric3 N;
  std::array<double, 3> Y;
  int slot;
};

struct PointBlock {
  Symmetric3 H;
  std::array<double, 3> g;
};

// Lower triangle of a camera's own block, and its gradient; stored as pairs for vector sums.
struct CameraBlock {
  static constexpr int kTt = 0;   // translation–translation, as Symmetric3
  static constexpr int kRt = 6;   // rotation–translation, row-major
  static constexpr int kRr = 15;  // rotation–rotation, as Symmetric3
  static constexpr int kG = 21;   // gradient: translation, rotation
  static constexpr int kSize = 27;
  std::array<Double2, (kSize + 1) / 2> sums;

  double operator[](int i) const { return sums[i / 2][i % 2]; }
  Matrix6d Hessian() const;
  Vector6d Gradient() const;
  void Add(const Matrix6d& H, const Vector6d& g);
};

struct StateBlock {  // of a state of the inertial sensor: own block and gradient
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};

struct Linearisation {
  std::vector<Coupling> couplings;  // point by point, in the layout's order
  std::vector<PointBlock> points;
  std::vector<CameraBlock> cameras;  // by slot
  std::vector<StateBlock> states;    // of the inertial sensor
  std::vector<Matrix6d> motion;      // MotionLayout::blocks
  double cost = 0;                   // ½ sum of weighted losses
  bool valid = true;                 // false: a point is behind a camera that observes it
};

// Linearizes at `state`. A point of `state` that is behind one of its cameras is reset to its
// position in `before`, if given; if that does not help, the result is not valid.
// Without `derivatives` only `cost` and `valid` of the result have a meaning.
void Linearise(const BundleLayout& layout, const BundleState* before, BundleState& state,
               Linearisation& result, bool derivatives = true);

}  // namespace alidade
