// Where the camera is by its last poses and the readings of the inertial sensor since. Used by the
// driving thread.
#pragma once

#include <optional>
#include <span>

#include "alidade/inertial/motion_belief.h"
#include "alidade/map/anchor.h"

namespace alidade {

class DeadReckoner {
 public:
  bool known() const { return belief_.has_value(); }
  void Forget() { belief_.reset(); }
  // Starts anew from a belief in the world of `anchor`: that of the camera at that moment.
  void Start(const MotionBelief& belief, const Anchor& anchor);
  // Takes a pose later than the last one into account.
  void See(const TimedPose& pose, KeyFrameId reference, const MapSnapshot& map,
           std::span<const ImuSample> samples);
  double time() const { return belief_->time; }
  // The belief at `time`, in the world of the map as it is now. nullopt: nothing is known, or the
  // map it was in is gone.
  std::optional<MotionBelief> At(double time, const MapSnapshot& map,
                                 std::span<const ImuSample> samples) const;
  // The same, started at `time`.
  std::optional<DeadReckoner> CarriedTo(double time, const MapSnapshot& map,
                                        std::span<const ImuSample> samples) const;
  KeyFrameId reference() const { return anchor_.keyframe; }
  void Reanchor(const MapSnapshot& map);

 private:
  // The belief at its own time, moved with the map.
  std::optional<MotionBelief> Present(const MapSnapshot& map) const;

  std::optional<MotionBelief> belief_;
  Anchor anchor_;  // of the camera at that time, without the error of the belief
};

}  // namespace alidade
