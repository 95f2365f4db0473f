// Online self-calibration: estimates focal length and radial distortion of an uncalibrated camera
// while its map grows (docs/development/decisions/0006-live-self-calibration.md).
#pragma once

#include <mutex>
#include <optional>
#include <span>

#include "alidade/base/api.h"
#include "alidade/calibration/camera_estimate.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"

namespace ALIDADE_API alidade {

struct Setting;

// For one camera with unknown calibration whose images come only once: live cameras, phones, images
// from a program. Recordings are better calibrated offline, before the run
// (run/calibration/find_camera.h). Range, unit and meaning: Table() in lens_watch.cc.
struct LensWatchSettings {
  bool enabled = false;
  int first_keyframes = 10;
  double growth = 1.3;
  int max_windows = 12;
  // With fewer, distortion is not separable from focal length. One less when the map was built
  // again with a better camera.
  int bend_windows = 3;
  double focal_sigma = 0.35;
  double readout_sigma = 0.02;
  // Two consecutive estimates must agree within 2 standard deviations, or lie on the same side of
  // the current value: then the nearer one is used.
  double max_sigma = 0.03;
  double far_off = 6;
  // A change below one standard deviation is not applied either.
  double min_change = 0.005;
  // A map agrees in part with the camera it was made with.
  int again = 2;
  // The focal length is settled to 0.1 %, a sixth of its standard deviation, long before far points
  // are.
  double settled = 2e-4;
  double settled_cost = 1e-3;
  // 3 % are 10 pixels at the image border.
  double step = 0.03;
  double rework = 0.03;
  // Such a camera has distorted the first seconds of a map: matches are missing. keep_frames are
  // six seconds at 30 Hz, some 200 kB each at 400 × 300.
  double begin_anew = 0.05;
  int keep_frames = 180;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
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
