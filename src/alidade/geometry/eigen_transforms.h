// Conversions between Se3, Sim3 and Eigen's transforms and 4x4 matrices.
#pragma once

#include <Eigen/Geometry>

#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

inline Eigen::Isometry3d ToIsometry(const Se3& T) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = T.R;
  isometry.translation() = T.t;
  return isometry;
}

// Rows (R t; 0 0 0 1).
inline Eigen::Matrix4d ToMatrix(const Se3& T) { return ToIsometry(T).matrix(); }

inline Se3 FromIsometry(const Eigen::Isometry3d& isometry) {
  return {isometry.linear(), isometry.translation()};
}

// Of a matrix (R t; 0 0 0 1). Throws Error (input) if it is none: the last row differs from 0 0 0
// 1, or R is not a rotation, by more than 1e-6. R is made orthonormal exactly.
Se3 FromMatrix(const Eigen::Matrix4d& matrix);

// Rows (s R, t; 0 0 0 1).
inline Eigen::Matrix4d ToMatrix(const Sim3& T) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = T.s * T.R;
  matrix.topRightCorner<3, 1>() = T.t;
  return matrix;
}

}  // namespace alidade
