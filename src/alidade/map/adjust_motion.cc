#include "alidade/map/adjust_motion.h"

#include <cmath>

#include "alidade/base/id_map.h"
#include "alidade/inertial/pose_measurement.h"

namespace alidade {
namespace {

Matrix9d CovarianceOf(const KeyFrameMotion& motion, double noise_share) {
  const Eigen::Matrix<double, 9, 3> by_gyro = motion.motion.by_bias.leftCols<3>();
  const double factor = motion.noise_factor / noise_share;
  return factor * factor *
         (motion.motion.covariance +
          motion.gyro_bias_sigma * motion.gyro_bias_sigma * by_gyro * by_gyro.transpose());
}

Eigen::Vector3d SensorOf(const MapSnapshot& map, KeyFrameId id, const Se3& T_camera_imu) {
  return (map.Find(id)->T_camera_world.Inverse() * T_camera_imu).t;
}

}  // namespace

BundleMotion MotionBetween(const MapSnapshot& map, const std::vector<KeyFrameId>& keyframes,
                           bool has_meters, double noise_share) {
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
    link.covariance = CovarianceOf(*motion, noise_share);
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
