#include "alidade/map/adjust_motion.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/id_map.h"
#include "alidade/inertial/pose_measurement.h"

namespace alidade {
namespace {

// With what is not known of the gyroscope's bias, of gravity, and of the scale of the keyframes
// that are held: an unknown acceleration.
Matrix9d CovarianceOf(const KeyFrameMotion& keyframe, double down_sigma, double scale_sigma) {
  const Preintegration& motion = keyframe.motion;
  const Eigen::Matrix<double, 9, 3> by_gyro = motion.by_bias.leftCols<3>();
  const double t = motion.seconds;
  const double unknown = kGravity * down_sigma + scale_sigma * motion.dv.norm() / t;  // m/s²
  Vector9d sigma = Vector9d::Zero();
  sigma.segment<3>(3).setConstant(unknown * t);
  sigma.tail<3>().setConstant(unknown * t * t / 2);
  Matrix9d covariance =
      keyframe.noise_factor * keyframe.noise_factor * motion.covariance +
      keyframe.gyro_bias_sigma * keyframe.gyro_bias_sigma * by_gyro * by_gyro.transpose();
  covariance.diagonal() += sigma.cwiseAbs2();
  return covariance;
}

Eigen::Vector3d SensorOf(const MapSnapshot& map, KeyFrameId id, const Se3& T_camera_imu) {
  return (map.Find(id)->T_camera_world.Inverse() * T_camera_imu).t;
}

}  // namespace

BundleMotion MotionBetween(const MapSnapshot& map, const std::vector<KeyFrameId>& keyframes,
                           bool has_meters, bool scale_held) {
  BundleMotion result;
  if (keyframes.empty()) return result;
  const MapWorld* world = map.WorldOf(map.MapOf(keyframes.front()));
  if (!world || !world->KnowsDown() || !(world->meters || has_meters)) return result;
  result.gravity = kGravity * world->down;
  IdMap<KeyFrameId, int> cameras, states;
  for (size_t i = 0; i < keyframes.size(); ++i) cameras[keyframes[i]] = static_cast<int>(i);
  const auto state_of = [&](KeyFrameId id, const KeyFrameMotion& motion) {
    if (const int* known = states.Find(id)) return *known;
    BundleMotionState state;
    state.camera = *cameras.Find(id);
    state.accel_bias = motion.motion.bias.accel;
    state.accel_bias_sigma = motion.accel_bias_sigma;
    result.states.push_back(state);
    return states[id] = static_cast<int>(result.states.size()) - 1;
  };
  for (KeyFrameId id : keyframes) {
    const KeyFrameMotion* motion = map.Find(id)->motion.get();
    if (!motion || !cameras.Find(motion->since)) continue;
    const double seconds = motion->motion.seconds;
    BundleMotionLink link;
    link.from = state_of(motion->since, *motion);
    link.to = state_of(id, *motion);
    result.states[link.to].accel_bias_sigma = 0;  // told by the walk of the one before
    link.motion = motion->motion;
    link.covariance = CovarianceOf(*motion, world->down_sigma, scale_held ? world->scale_sigma : 0);
    link.accel_walk = motion->accel_walk * std::sqrt(seconds);
    result.links.push_back(link);
    result.T_camera_imu = motion->T_camera_imu;
    const Eigen::Vector3d way = SensorOf(map, id, motion->T_camera_imu) -
                                SensorOf(map, motion->since, motion->T_camera_imu);
    result.states[link.from].velocity = result.states[link.to].velocity = way / seconds;
  }
  return result;
}

void WeighBy(double noise_share, BundleMotion& motion) {
  constexpr double kLeast = 0.2;
  const double factor = 1 / std::clamp(noise_share, kLeast, 1.0);
  for (BundleMotionState& state : motion.states) state.accel_bias_sigma *= factor;
  for (BundleMotionLink& link : motion.links) {
    link.covariance *= factor * factor;
    link.accel_walk *= factor;
  }
}

}  // namespace alidade
