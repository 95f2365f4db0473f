#include "alidade/system/inertial/keyframe_motions.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace alidade {
namespace {

// Noise of the readings, as a share of what is assumed, which is on the safe side: what is above in
// a fit is the error of the poses.
constexpr double kLeastNoise = 0.3, kMostNoise = 1;
constexpr double kLongestMotion = 3;  // seconds: after that it tells little

bool Covered(std::span<const ImuSample> samples, double from, double to) {
  return !samples.empty() && from >= samples.front().time && to <= samples.back().time &&
         TellMotion(samples, from, to);
}

// Whether the gyroscope turned as the camera did: within the noise that a fit may have, or so that
// it explains three quarters of the turn. Poses may be wrong, too, and motions are to hold them;
// but a wrong motion bends the map before the next fit can tell.
bool TurnsAlike(const Preintegration& motion, const KeyFrame& since, const KeyFrame& keyframe,
                const InertialFit& fit) {
  const Eigen::Matrix3d& R = fit.model.T_camera_imu.R;
  const Eigen::Matrix3d turn =
      R.transpose() * since.T_camera_world.R * keyframe.T_camera_world.R.transpose() * R;
  const double angle = LogSo3(turn).norm();
  const double variance = motion.covariance.topLeftCorner<3, 3>().diagonal().maxCoeff() +
                          std::pow(fit.gyro_bias_sigma * motion.seconds, 2) +
                          std::pow(fit.rotation_sigma * angle, 2) + 2 * CommonErrors(0)(5, 5);
  const double error = LogSo3(motion.dR.transpose() * turn).squaredNorm();
  return error < 3 * kMostNoiseFactor * kMostNoiseFactor * variance || 4 * std::sqrt(error) < angle;
}

}  // namespace

KeyFrameMotions::Motions KeyFrameMotions::Missing(const MapSnapshot& map, MapId in,
                                                  const InertialFit& fit,
                                                  std::span<const ImuSample> samples,
                                                  double doubted) {
  Motions motions;
  if (map_ != in) {
    map_ = in;
    next_ = KeyFrameId{0};
  }
  const KeyFrame* before = nullptr;
  for (uint32_t i = next_.value; i-- > 0 && !before;) {
    const KeyFrame* keyframe = map.Find(KeyFrameId{i});
    if (keyframe && keyframe->map == in) before = keyframe;
  }
  const double offset = fit.model.time_offset;
  for (; next_.value < map.next_keyframe(); ++next_.value) {
    const KeyFrame* keyframe = map.Find(next_);
    if (!keyframe || keyframe->map != in) continue;
    const double to = keyframe->frame->time + offset;
    if (!samples.empty() && to > samples.back().time) break;  // later
    const KeyFrame* since = std::exchange(before, keyframe);
    if (!since || keyframe->motion || since->frame->time < doubted) continue;
    const double from = since->frame->time + offset;
    if (!(to > from) || to - from > kLongestMotion || !Covered(samples, from, to)) continue;
    auto motion = std::make_shared<KeyFrameMotion>();
    motion->since = since->id;
    const ImuNoise noise = InUse(fit.model.noise);
    motion->motion = Preintegrate(samples, from, to, fit.states.back().bias, noise);
    if (!TurnsAlike(motion->motion, *since, *keyframe, fit)) continue;
    motion->T_camera_imu = fit.model.T_camera_imu;
    motion->gyro_bias_sigma = fit.gyro_bias_sigma;
    motion->accel_bias_sigma = fit.accel_bias_sigma;
    motion->accel_walk = noise.accel_walk;
    motion->noise_factor = std::clamp(fit.noise_factor, kLeastNoise, kMostNoise);
    motions.push_back({keyframe->id, std::move(motion)});
  }
  return motions;
}

}  // namespace alidade
