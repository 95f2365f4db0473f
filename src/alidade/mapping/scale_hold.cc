#include "alidade/mapping/scale_hold.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "alidade/geometry/se3.h"
#include "alidade/map/view.h"

namespace alidade {

Eigen::Matrix3d CentreCovariance(const MapSnapshot& map, const KeyFrame& keyframe,
                                 const Camera& camera, const MeasurementNoise& noise) {
  constexpr double kLeast = 1e-9;  // keeps it invertible without landmarks
  // Information matrices: center (A), center–rotation (B), rotation (C).
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity() * kLeast, B = Eigen::Matrix3d::Zero(), C = A;
  for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (!keyframe.landmarks[i].valid()) continue;
    const Landmark* landmark = map.Find(keyframe.landmarks[i]);
    if (!landmark || !landmark->scale_known) continue;
    const Eigen::Vector3d p = keyframe.T_camera_world * landmark->p_world;
    if (p.z() <= 0) continue;
    const double sigma = noise.sigma_px * ScaleOfLevel(keyframe.frame->keypoints[i].level);
    const double u = camera.fx / (sigma * p.z()), v = camera.fy / (sigma * p.z());
    Eigen::Matrix<double, 2, 3> of_point;  // d pixel / d p, in sigma
    of_point << u, 0, -u * p.x() / p.z(), 0, v, -v * p.y() / p.z();
    // p = R (p_world - centre), rotated by a small angle w: dp = -R d centre - [p]x w.
    const Eigen::Matrix<double, 2, 3> of_centre = of_point * keyframe.T_camera_world.R;
    const Eigen::Matrix<double, 2, 3> of_turn = of_point * Skew(p);
    A += of_centre.transpose() * of_centre;
    B += of_centre.transpose() * of_turn;
    C += of_turn.transpose() * of_turn;
  }
  return (A - B * C.inverse() * B.transpose()).inverse();
}

std::vector<KeyFrameId> AtKnownDistance(const MapSnapshot& map, const KeyFrame& keyframe,
                                        const Camera& camera, const MapperSettings& settings) {
  const double least = settings.min_baseline_ratio * MedianDepth(map, keyframe).value_or(1);
  const Eigen::Matrix3d covariance = CentreCovariance(map, keyframe, camera, settings.noise);
  std::vector<KeyFrameId> known;
  int looked_at = 0;
  for (const Neighbour& neighbour : keyframe.covisible) {
    const KeyFrame* other = map.Find(neighbour.id);
    if (!other) continue;
    const Eigen::Vector3d apart = other->Centre() - keyframe.Centre();
    const double distance = apart.norm();
    if (distance < least) continue;
    if (++looked_at > settings.triangulate_keyframes_mono) break;
    const Eigen::Vector3d along = apart / distance;
    const Eigen::Matrix3d of_both =
        covariance + CentreCovariance(map, *other, camera, settings.noise);
    if (std::sqrt(along.dot(of_both * along)) <= settings.max_baseline_error * distance)
      known.push_back(neighbour.id);
  }
  return known;
}

std::vector<LandmarkId> ScaleFoundFrom(const MapSnapshot& map, const KeyFrame& keyframe,
                                       const std::vector<KeyFrameId>& others) {
  std::vector<LandmarkId> found;
  for (LandmarkId id : keyframe.landmarks) {
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (!landmark || landmark->scale_known || landmark->depth_assumed) continue;
    const bool seen = std::any_of(
        landmark->observations.begin(), landmark->observations.end(), [&](const Observation& at) {
          return std::find(others.begin(), others.end(), at.keyframe) != others.end();
        });
    if (seen) found.push_back(id);
  }
  return found;
}

}  // namespace alidade
