// Homography between two views of a plane, or of any scene under pure rotation: b ~ H_b_a * a.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Normalized DLT (Hartley & Zisserman, algorithm 4.2): minimizes the algebraic error over 4 or more
// point pairs. |H| = 1. Degenerate points give an arbitrary matrix; non-finite points give a
// non-finite one.
Eigen::Matrix3d EstimateHomography(std::span<const Eigen::Vector2d> a,
                                   std::span<const Eigen::Vector2d> b);

// The 8 motions T_b_a (|t| = 1) compatible with a homography between points at unit focal length
// (Faugeras & Lustman 1988). At most two of them place the points in front of both cameras. Empty
// for a pure rotation or a non-finite or singular matrix.
std::vector<Se3> MotionsFromHomography(const Eigen::Matrix3d& H_b_a);

}  // namespace alidade
