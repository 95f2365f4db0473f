// Homography between two views of a plane (or of anything, by a camera that only turns): b ~ H_b_a
// * a.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Least algebraic error over 4 or more pairs of points, after normalising (Hartley & Zisserman,
// algorithm 4.2), of norm 1. Where the points do not determine one, some matrix; not finite when
// the points are not.
Eigen::Matrix3d EstimateHomography(std::span<const Eigen::Vector2d> a,
                                   std::span<const Eigen::Vector2d> b);

// The motions T_b_a (|t| = 1) that could have made the homography H_b_a between points at unit
// focal length: 8 of them (Faugeras & Lustman 1988), at most two of which leave the points in front
// of both cameras. None when the camera only turned.
std::vector<Se3> MotionsFromHomography(const Eigen::Matrix3d& H_b_a);

}  // namespace alidade
