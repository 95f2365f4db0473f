// Fundamental and essential matrix between two views: b' * F_b_a * a = 0.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Least algebraic error over 8 or more pairs of points, after normalising, made rank 2 (Hartley &
// Zisserman, algorithm 11.1), of norm 1. Where the points do not determine one, some matrix; not
// finite when the points are not.
Eigen::Matrix3d EstimateFundamental(std::span<const Eigen::Vector2d> a,
                                    std::span<const Eigen::Vector2d> b);

// The four motions T_b_a (|t| = 1) of an essential matrix (Hartley & Zisserman, result 9.19), of
// which one leaves the points in front of both cameras. The nearest essential matrix is taken when
// it is not quite one.
std::vector<Se3> MotionsFromEssential(const Eigen::Matrix3d& E_b_a);

// E such that b' * E_b_a * a = 0 between points at unit focal length (Hartley & Zisserman 9.12).
inline Eigen::Matrix3d EssentialFromMotion(const Se3& T_b_a) { return Skew(T_b_a.t) * T_b_a.R; }

}  // namespace alidade
