#include "alidade/map/adjust_motion.h"

#include <cmath>

#include "alidade/base/id_map.h"
#include "alidade/inertial/pose_measurement.h"

namespace alidade {
namespace {

// With what is not known of the gyroscope's bias, of gravity, and of the scale of the keyframes
// that are held.
Matrix9d CovarianceOf(const KeyFrameMotion& keyframe, const MapWorld& world, double scale_sigma,
                      double noise_share) {
  const Preintegration& motion = keyframe.motion;
  const Eigen::Matrix<double, 9, 3> by_gyro = motion.by_bias.leftCols<3>();
  const double t = motion.seconds, gravity = kGravity * world.down_sigma;
  Vector9d unknown = Vector9d::Zero();
  unknown.segment<3>(3).setConstant(gravity * t);
  unknown.tail<3>().setConstant(gravity * t * t / 2);
  const double accelerated = (motion.dv / t).norm();
  unknown.segment<3>(3).array() += scale_sigma * accelerated * t;
  unknown.tail<3>().array() += scale_sigma * accelerated * t * t / 2;
  const double factor = 1 / (noise_share * noise_share);
  Matrix9d covariance =
      factor *
      (keyframe.noise_factor * keyframe.noise_factor * motion.covariance +
       keyframe.gyro_bias_sigma * keyframe.gyro_bias_sigma * by_gyro * by_gyro.transpose());
  covariance.diagonal() += factor * unknown.cwiseAbs2();
  return covariance;
}

Eigen::Vector3d SensorOf(const MapSnapshot& map, KeyFrameId id, const Se3& T_camera_imu) {
  return (map.Find(id)->T_camera_world.Inverse() * T_camera_imu).t;
}

}  // namespace

BundleMotion MotionBetween(const MapSnapshot& map, const std::vector<KeyFrameId>& keyframes,
                           bool has_meters, bool scale_held, double noise_share) {
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
    state.accel_bias_sigma = motion.accel_bias_sigma / noise_share;
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
    link.covariance =
        CovarianceOf(*motion, *world, scale_held ? world->scale_sigma : 0, noise_share);
    link.accel_walk = motion->accel_walk * std::sqrt(seconds) / noise_share;
    result.links.push_back(link);
    result.T_camera_imu = motion->T_camera_imu;
    const Eigen::Vector3d way = SensorOf(map, id, motion->T_camera_imu) -
                                SensorOf(map, motion->since, motion->T_camera_imu);
    result.states[link.from].velocity = result.states[link.to].velocity = way / seconds;
  }
  return result;
}

}  // namespace alidade
