#include "alidade/system/camera/camera_update.h"

#include "alidade/calibration/camera_estimate.h"
#include "alidade/features/undistort.h"

namespace alidade {

void CameraUpdate::Apply(const Camera& camera) {
  const bool in_newest_map =
      parts_.session.state() == SessionState::kTracking &&
      parts_.workers.map().Snapshot().MapOf(parts_.tracker.reference()) == parts_.young.map();
  const bool far_off =
      Apart(parts_.kept.started_with(), camera) > parts_.settings.refine.begin_anew;
  // Dynamics need images, which are not kept.
  if (in_newest_map && far_off && parts_.replay.Possible() && !parts_.movers.on()) {
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
  parts_.left_out.SetCamera(camera);
  parts_.young.SetCamera(camera, parts_.workers.lens_watch().found()->focal_sigma);
  parts_.early.SetCamera(camera);
}

void CameraUpdate::Rebuild(const Camera& camera) {
  parts_.replay.Run(
      [&] {
        ChangeEverywhere(camera);
        parts_.workers.AskAnew();
        parts_.tracker.SetReadout(parts_.workers.readout());
      },
      [&](Frame& frame) {
        UndistortKeypoints(parts_.camera, frame);
        parts_.left_out.RemoveFrom(frame, parts_.camera);
        frame.motion.setZero();
      });
}

}  // namespace alidade
