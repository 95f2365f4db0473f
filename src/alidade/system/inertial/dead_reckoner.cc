#include "alidade/system/inertial/dead_reckoner.h"

namespace alidade {

void DeadReckoner::Start(const MotionBelief& belief, const Anchor& anchor) {
  belief_ = belief;
  anchor_ = anchor;
}

std::optional<MotionBelief> DeadReckoner::Present(const MapSnapshot& map) const {
  if (!belief_) return std::nullopt;
  const Anchor anchor = Reanchored(map.state(), anchor_);
  if (!anchor.keyframe.valid()) return std::nullopt;
  MotionBelief belief = *belief_;
  Se3 before = belief.T_world_camera();
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
  Start(*belief, AnchorTo(map.state(), reference, belief->T_world_camera().Inverse()));
}

std::optional<MotionBelief> DeadReckoner::At(double time, const MapSnapshot& map,
                                             std::span<const ImuSample> samples) const {
  const std::optional<MotionBelief> belief = Present(map);
  if (!belief) return std::nullopt;
  return belief->At(time, samples);
}

std::optional<DeadReckoner> DeadReckoner::CarriedTo(double time, const MapSnapshot& map,
                                                    std::span<const ImuSample> samples) const {
  const std::optional<MotionBelief> belief = At(time, map, samples);
  if (!belief) return std::nullopt;
  const KeyFrameId reference = Reanchored(map.state(), anchor_).keyframe;
  DeadReckoner carried;
  carried.Start(*belief, AnchorTo(map.state(), reference, belief->T_world_camera().Inverse()));
  return carried;
}

void DeadReckoner::Reanchor(const MapSnapshot& map) {
  anchor_ = Reanchored(map.state(), anchor_);
  if (!anchor_.keyframe.valid()) Forget();
}

}  // namespace alidade
