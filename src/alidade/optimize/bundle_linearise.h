// Normal equations of bundle adjustment, before anything is eliminated.
//
// Cameras are held as rotation R and centre c: a point is seen at p = R (X - c). A step turns a
// camera about its own centre, in world axes: p(ρ, θ) = R Exp(θ) (X - c + ρ). With Y = X - c and B
// = dr/dX the camera's Jacobian is B [I, -[Y]x], so that one symmetric matrix N = B' W B serves all
// blocks of J' W J:
//   point–point N,   camera–point G N,   camera–camera G N G',   G = [I; [Y]x].
#pragma once

#include <array>
#include <vector>

#include "alidade/optimize/bundle_layout.h"
#include "alidade/optimize/double2.h"

namespace alidade {

struct BundleCamera {
  Eigen::Matrix3d R;       // camera from world
  Eigen::Vector3d centre;  // in the world
};

struct BundleState {
  std::vector<BundleCamera> cameras;    // all of the problem
  std::vector<Eigen::Vector3d> points;  // as in the layout
};

// Symmetric 3x3: xx, xy, xz, yy, yz, zz.
using Symmetric3 = std::array<double, 6>;

struct Coupling {  // of a free camera and a point
  Symmetric3 N;
  std::array<double, 3> Y;
  int slot;
};

struct PointBlock {
  Symmetric3 H;
  std::array<double, 3> g;
};

// Lower triangle of the camera's own block, and its gradient. Kept two by two, as they are summed.
struct CameraBlock {
  static constexpr int kTt = 0;   // translation–translation, as Symmetric3
  static constexpr int kRt = 6;   // rotation–translation, row by row
  static constexpr int kRr = 15;  // rotation–rotation, as Symmetric3
  static constexpr int kG = 21;   // gradient by translation, rotation
  static constexpr int kSize = 27;
  std::array<Double2, (kSize + 1) / 2> sums;

  double operator[](int i) const { return sums[i / 2][i % 2]; }
  Matrix6d Hessian() const;
  Vector6d Gradient() const;
};

struct Linearisation {
  std::vector<Coupling> couplings;  // point by point, in the order of the layout
  std::vector<PointBlock> points;
  std::vector<CameraBlock> cameras;  // by slot
  double cost = 0;                   // ½ sum of losses by trust
  bool valid = true;                 // no point behind a camera that should see it
};

// A point of `state` that is behind one of its cameras is put back to where `before` has it, if
// given; where that does not help either, the result is not valid.
void Linearise(const BundleLayout& layout, const BundleState* before, BundleState& state,
               Linearisation& result);

}  // namespace alidade
