#include "alidade/system/inertial/dead_reckoner.h"

namespace alidade {
namespace {

// In map units.
Se3 CameraOf(const MotionBelief& belief) {
  Se3 T = belief.state.T_world_imu * belief.common.model.T_camera_imu.Inverse();
  T.t /= belief.common.scale;
  return T;
}

}  // namespace

void DeadReckoner::Start(const MotionBelief& belief, const Anchor& anchor) {
  belief_ = belief;
  anchor_ = anchor;
}

std::optional<MotionBelief> DeadReckoner::Present(const MapSnapshot& map) const {
  if (!belief_) return std::nullopt;
  const Anchor anchor = Reanchored(map.state(), anchor_);
  if (!anchor.keyframe.valid()) return std::nullopt;
  MotionBelief belief = *belief_;
  Se3 before = CameraOf(belief);
  belief.common.scale /= map.ScaleOf(anchor.keyframe) / anchor.scale;
  Se3 now = PoseOf(map.state(), anchor).Inverse();
  before.t *= belief_->common.scale;
  now.t *= belief.common.scale;
  belief.Move(now * before.Inverse());
  return belief;
}

void DeadReckoner::See(const TimedPose& pose, KeyFrameId reference, const MapSnapshot& map,
                       std::span<const ImuSample> samples) {
  std::optional<MotionBelief> belief = At(pose.time, map, samples);
  if (!belief || !belief->See(pose, samples)) return Forget();
  Start(*belief, AnchorTo(map.state(), reference, CameraOf(*belief).Inverse()));
}

std::optional<MotionBelief> DeadReckoner::At(double time, const MapSnapshot& map,
                                             std::span<const ImuSample> samples) const {
  const std::optional<MotionBelief> belief = Present(map);
  if (!belief) return std::nullopt;
  return belief->At(time, samples);
}

void DeadReckoner::Reanchor(const MapSnapshot& map) {
  anchor_ = Reanchored(map.state(), anchor_);
  if (!anchor_.keyframe.valid()) Forget();
}

}  // namespace alidade
