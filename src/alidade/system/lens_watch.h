// Online self-calibration: estimates focal length and radial distortion of an uncalibrated camera
// while its map grows (docs/development/decisions/0006-live-self-calibration.md).
#pragma once

#include <mutex>
#include <optional>

#include "alidade/base/api.h"
#include "alidade/map/camera_estimate.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"

namespace ALIDADE_API alidade {

// For one camera with unknown calibration whose images come only once: live cameras, phones, images
// from a program. Recordings are better calibrated offline, before the run (run/calibration/find_camera.h).
struct LensWatchSettings {
  bool enabled = false;      // false: the camera is taken as it is given
  int first_keyframes = 10;  // of a map, when it is asked first …
  double growth = 1.3;       // … and again when it has so many times as many
  int max_windows = 12;      // stretches of 12 keyframes that are asked, spread over the map
  // Stretches there must be for distortion to be asked for (else it is none): in one or two, which
  // a wrong lens has bent, it is taken for focal length and runs away with it.
  // One less when the map was begun anew with a better camera.
  int bend_windows = 3;
  double focal_sigma = 0.35;    // believed of log focal beforehand: 66 degrees may be 49 to 85
  double readout_sigma = 0.02;  // seconds: believed of a rolling shutter beforehand, about none
  // Relative standard deviation of the focal length, above which it is not taken, unless the camera
  // is off by so many of them; two answers on end must agree on it to two of theirs, or lie on the
  // same side: then the nearer one is taken.
  double max_sigma = 0.03, far_off = 6;
  // Share of a pixel's distance from the middle, below which all stays as it is; so it does where
  // less than one standard deviation would change.
  double min_change = 0.005;
  // A map agrees in part with the camera it was made with: after a change by more than twice
  // `min_change` it is asked again when it has so many keyframes more.
  int again = 2;
  // An answer is there when a step of its adjustment moves log focal, k1 and k2 by less than this
  // and lowers the cost by a smaller share than that: the focal length is settled to a tenth of a
  // per cent, a sixth of its standard deviation, long before points far away are.
  double settled = 2e-4, settled_cost = 1e-3;
  // The map is bent to another camera in steps of so large a share, with an adjustment after each:
  // at the picture's rim 3 % are 10 pixels.
  double step = 0.03;
  // After a change by more than this share all keyframes are mapped again, for what a wrong lens
  // did not match.
  double rework = 0.03;
  // A camera that is off by more than this share from what the map was begun with has bent its
  // first seconds beyond mending: what belongs together was not matched. The map is then begun anew
  // from the frames' features, which are kept for it: `keep_frames` since its first, at 30 a second
  // six seconds, some 200 kB each at 400x300. 0: never.
  double begin_anew = 0.05;
  int keep_frames = 180;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

class LensWatch {
 public:
  LensWatch(const Camera& camera, const MeasurementNoise& noise, const LensWatchSettings& settings);

  // Call after each mapped keyframe: estimates the camera from the largest map if that has grown
  // enough. Mapping thread.
  void Mapped(const MapSnapshot& map);
  // Estimates the camera from the largest map now. `last`: no estimate will follow, so a
  // sufficiently certain one is accepted without a second one that agrees. Not while Mapped() runs.
  void Ask(const MapSnapshot& map, bool last = false);
  // The camera that the map should be changed to; returned once. Any thread.
  std::optional<Camera> Take();
  // The map was changed to this camera. Not while Mapped() runs.
  void SetCamera(const Camera& camera) { camera_ = camera; }
  // The map was dropped and is rebuilt with a better camera. Not while Mapped() runs.
  void BeginAnew();
  // The estimate so far; nullopt: none was accepted. Any thread.
  std::optional<CameraEstimate> found() const;
  const LensWatchSettings& settings() const { return settings_; }

 private:
  struct Answer {
    CameraEstimate estimate;
    // Relative standard deviation of the focal length that is due to distortion, if that was not
    // estimated.
    double unasked = 0;
  };
  std::optional<Answer> Agreed(const std::optional<Answer>& before, const Answer& now,
                               bool last) const;
  void Believe(const Answer& answer, int keyframes);

  Camera camera_;
  MeasurementNoise noise_;
  LensWatchSettings settings_;
  int ask_at_;                    // keyframes of the largest map at the next estimate
  std::optional<Answer> before_;  // the previous answer
  bool anew_ = false;             // the map was rebuilt with a better camera
  mutable std::mutex mutex_;
  std::optional<CameraEstimate> found_;
  std::optional<Camera> wanted_;  // for Take()
};

}  // namespace alidade
