// Fundamental and essential matrix between two views: b' * F_b_a * a = 0 for homogeneous points.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Normalized 8-point algorithm (Hartley & Zisserman, algorithm 11.1): minimizes the algebraic error
// over 8 or more point pairs, then enforces rank 2. |F| = 1. Degenerate points give an arbitrary
// matrix; non-finite points give a non-finite one.
Eigen::Matrix3d EstimateFundamental(std::span<const Eigen::Vector2d> a,
                                    std::span<const Eigen::Vector2d> b);

// The four motions T_b_a (|t| = 1) of an essential matrix (Hartley & Zisserman, result 9.19);
// exactly one of them places the points in front of both cameras. A matrix that is not exactly
// essential is replaced by the nearest one that is. Empty if E is not finite.
std::vector<Se3> MotionsFromEssential(const Eigen::Matrix3d& E_b_a);

// E with b' * E_b_a * a = 0 for points at unit focal length (Hartley & Zisserman, eq. 9.12).
inline Eigen::Matrix3d EssentialFromMotion(const Se3& T_b_a) { return Skew(T_b_a.t) * T_b_a.R; }

}  // namespace alidade
