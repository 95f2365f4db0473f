#include "alidade/map/landmark_covariance.h"

#include <Eigen/Dense>

namespace alidade {

std::optional<Eigen::Matrix3d> LandmarkCovariance(const MapSnapshot& map, LandmarkId id,
                                                  const Camera& camera,
                                                  const MeasurementNoise& noise) {
  const Landmark* landmark = map.Find(id);
  if (!landmark || landmark->depth_assumed) return std::nullopt;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  int rows = 0;
  for (const Observation& observation : landmark->observations) {
    const KeyFrame* keyframe = map.Find(observation.keyframe);
    if (!keyframe) continue;
    const Eigen::Vector3d p = keyframe->T_camera_world * landmark->p_world;
    if (!(p.z() > 0)) continue;
    const Measurement seen = Measure(keyframe->frame->keypoints[observation.keypoint], noise);
    // Derivatives of u, v, and of the column in the right image, u - bf / z.
    const double fx = camera.fx / p.z(), fy = camera.fy / p.z();
    Eigen::Matrix3d J;
    J << fx, 0, -fx * p.x() / p.z(), 0, fy, -fy * p.y() / p.z(), fx, 0,
        (camera.bf() / p.z() - fx * p.x()) / p.z();
    J = (J * keyframe->T_camera_world.R).eval();
    const bool right = seen.pixel.z() == seen.pixel.z();  // not NaN
    const Eigen::Vector3d weights(seen.inv_sigma2, seen.inv_sigma2,
                                  right ? seen.inv_sigma2_right : 0);
    information += J.transpose() * weights.asDiagonal() * J;
    rows += right ? 3 : 2;
  }
  if (rows < 3) return std::nullopt;
  bool invertible = false;
  Eigen::Matrix3d covariance;
  // In units of the largest entry, so that the test of the determinant has no unit.
  const double unit = information.maxCoeff();
  (information / unit).eval().computeInverseWithCheck(covariance, invertible, 1e-12);
  if (!invertible) return std::nullopt;
  return covariance / unit;
}

}  // namespace alidade
