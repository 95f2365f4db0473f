#include "alidade/system/camera_update.h"

#include <memory>
#include <new>

#include "alidade/calibration/camera_estimate.h"
#include "alidade/features/undistort.h"

namespace alidade {
namespace {

constexpr int kMostRebuilds = 3;  // per run: each estimate is nearer to the true camera

}  // namespace

void CameraUpdate::Apply(const Camera& camera) {
  const bool in_newest_map =
      parts_.session.state() == SessionState::kTracking &&
      parts_.workers.map().Snapshot().MapOf(parts_.tracker.reference()) == parts_.young.map();
  const bool far_off =
      Apart(parts_.kept.started_with(), camera) > parts_.settings.refine.begin_anew;
  // Dynamics need images, which are not kept.
  if (in_newest_map && far_off && parts_.kept.CanRebuild() && !parts_.movers.on() &&
      rebuilt_ < kMostRebuilds) {
    Rebuild(camera);
  } else {
    ChangeEverywhere(camera);
  }
}

void CameraUpdate::ChangeEverywhere(const Camera& camera) {
  parts_.workers.ChangeCamera(parts_.camera, camera);
  parts_.camera = camera;
  parts_.shown.Set(camera);
  parts_.tracker.SetCamera(camera);
  parts_.movers.SetCamera(camera);
  parts_.young.SetCamera(camera, parts_.workers.lens_watch().found()->focal_sigma);
  parts_.early.SetCamera(camera);
}

// Makes the map as a second pass over the frames would. The images are gone, so keyframes among
// these frames have no dense depth. If memory runs out, the map ends there and goes on with new
// frames.
void CameraUpdate::Rebuild(const Camera& camera) {
  ++rebuilt_;
  parts_.session.Apply(SessionEvent::kRebuildStarted);
  parts_.workers.AwaitDrop();  // so that the dropped map is not adjusted to the new camera
  ChangeEverywhere(camera);
  parts_.workers.AskAnew();
  parts_.tracker.SetReadout(parts_.workers.readout());
  try {
    const auto frames = parts_.kept.frames();  // a copy: an event during the replay may erase them
    for (const KeptFrames::Kept& kept : frames) ReplayFrame(kept);
  } catch (const std::bad_alloc&) {
    parts_.young.ForgetViews();
  }
}

void CameraUpdate::ReplayFrame(const KeptFrames::Kept& kept) {
  PresentFrame now;
  now.frame = std::make_shared<Frame>(*kept.frame);
  now.placed.frame = now.frame;
  now.index = kept.index;
  now.replayed = true;
  UndistortKeypoints(parts_.camera, *now.frame);
  now.frame->motion.setZero();
  const TrackResult result = replay_(now);
  if (parts_.session.state() != SessionState::kSeeking) now.frame->glance.release();
  if (result.state == TrackState::kTracking) parts_.early.Tracked(*now.frame, now.index);
  parts_.workers.AwaitMapping();
}

}  // namespace alidade
