// How the pipeline gets from an image to keypoints: aligned with an earlier frame, or extracted.
#include <memory>
#include <utility>

#include "alidade/features/glance.h"
#include "alidade/system/frame_pipeline.h"
#include "alidade/system/movers.h"
#include "alidade/system/prepare.h"

namespace alidade {

// Whether the frame may do without features of its own. Frames that are processed again later need
// them, and so do all frames where moving objects are left out (decision 0038).
bool FramePipeline::MayAlign(int number) const {
  return settings_.tracker.align && session_.state() == SessionState::kTracking && !movers_.on() &&
         !young_.WantsGlance(number) && !early_.Wants(number) && !CollectsForRebuild() &&
         !KeepsForFixedParts();
}

// False: the frame needs features.
bool FramePipeline::AlignFrame(const FrameInput& prepared, double time, PresentFrame& now) {
  const int number = NumberOf(now.index);
  if (!MayAlign(number)) return false;
  const Stopwatch watch;
  MapSnapshot map = workers_.map().Snapshot();
  tracker_.SetTurn(time, inertial_.TurnBetween(tracker_.last_time(), time));
  std::optional<TrackEstimate> estimate =
      tracker_.Align(prepared.image, prepared.depth, time, number, left_out_.With({}), map);
  if (!estimate) return false;
  now.frame = std::const_pointer_cast<Frame>(estimate->placed.frame);
  now.placed.frame = now.frame;
  track_ms_.Add(watch.Milliseconds());
  const PoseGuess where = GuessOf(estimate->placed, tracker_.reference(), map);
  movers_.Judge(*now.frame, &where);
  WatchReadout(*estimate, map);
  now.aligned = AlignedEstimate{std::move(*estimate), std::move(map)};
  return true;
}

void FramePipeline::ExtractFeatures(const FrameInput& prepared, double time, PresentFrame& now) {
  const int number = NumberOf(now.index);
  const bool tracked = session_.has_pose();
  const Stopwatch watch;
  now.frame = tracker_.Extract(prepared.image, prepared.right, prepared.depth, time, number,
                               left_out_.With(movers_.Expected()));
  extract_ms_.Add(watch.Milliseconds());
  if (dense_) now.frame->picture = PictureOf(prepared);
  if (settings_.sensor == Sensor::kMono &&
      (!tracked || young_.WantsGlance(number) || CollectsForRebuild()))
    now.frame->glance = Glance(prepared.image);
  left_out_.RemoveFrom(*now.frame, camera_);
  now.placed.frame = now.frame;
}

// The residuals of the frame tell the readout time of a rolling shutter.
void FramePipeline::WatchReadout(const TrackEstimate& estimate, const MapSnapshot& map) {
  if (!settings_.readout.enabled || camera_.readout_known) return;
  workers_.readout_watch().Placed(estimate.placed.frame->motion,
                                  tracker_.ReadoutMatches(estimate, map));
}

// Optical flow is compared with poses only when the focal length is trusted: with a wrong one the
// whole scene seems to move. During online self-calibration that is once the estimate is known and
// the map is no longer rebuilt because of it.
bool FramePipeline::TrustsFocalLength() const {
  if (settings_.refine.enabled) {
    if (CollectsForRebuild()) return false;
    const std::optional<CameraEstimate> found = workers_.lens_watch().found();
    return found && found->known;
  }
  return settings_.start.two_view.lens_uncertainty <= settings_.dynamics.watch_lens;
}

// Whether frames are kept to rebuild the map with another camera. Dynamics need images, which are
// not kept; a loaded map is not rebuilt.
bool FramePipeline::CollectsForRebuild() const {
  return settings_.refine.enabled && settings_.sensor == Sensor::kMono && kept_.keeps() &&
         !movers_.on() && first_number_ == 0;
}

bool FramePipeline::KeepsForFixedParts() const {
  return settings_.sensor != Sensor::kMono && settings_.fixed_parts && !settings_.localize &&
         kept_.keeps() && first_number_ == 0;
}

}  // namespace alidade
