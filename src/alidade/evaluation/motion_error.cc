#include "alidade/evaluation/motion_error.h"

#include <Eigen/LU>

namespace alidade {

double MotionChiSquared(const UncertainPose& a, const UncertainPose& b, const Se3& T_a_b_true) {
  const Se3 T_b_a = b.T_world_camera.Inverse() * a.T_world_camera;
  const Matrix6d covariance = b.covariance + Carried(T_b_a, a.covariance);
  const Vector6d xi = (T_b_a * T_a_b_true).Log();
  return xi.dot(covariance.inverse() * xi);
}

}  // namespace alidade
