#include "alidade/geometry/eigen_transforms.h"

#include "alidade/base/error.h"

namespace alidade {

Se3 FromMatrix(const Eigen::Matrix4d& matrix) {
  constexpr double kMostError = 1e-6;
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const Eigen::RowVector4d last = matrix.row(3);
  // Conditions are written so that NaN fails them.
  if (!((last - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() <= kMostError))
    ThrowInput("the last row of a pose's 4x4 matrix must be 0 0 0 1: is the matrix transposed?");
  if (!((R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kMostError) ||
      !(R.determinant() > 0))
    ThrowInput("the upper left 3x3 of a pose's 4x4 matrix must be a rotation, without scale");
  if (!matrix.allFinite()) ThrowInput("a pose's 4x4 matrix has a number that is not finite");
  return Se3{R, matrix.topRightCorner<3, 1>()}.Normalised();
}

}  // namespace alidade
