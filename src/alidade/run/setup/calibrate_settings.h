// How the camera of a recording is found before the run (run/calibration/find_camera.h).
#pragma once

#include <span>

#include "alidade/calibration/camera_estimate.h"

namespace alidade {

// Range, unit and meaning: Table() in calibrate_settings.cc, and that of CameraEstimateSettings.
struct CalibrateSettings : CameraEstimateSettings {
  // A rolling shutter distorts images as a wrong lens does: both are estimated at once. Phones and
  // webcams take 10 to 30 ms, others none.
  CalibrateSettings() { readout_sigma = 0.02; }

  bool enabled = true;
  // A map made with a wrong camera is distorted the more the longer it gets.
  double max_off = 0.06;
  double max_restart_sigma = 0.02;
  // A map made with a very wrong camera says little, but points in the right direction.
  double max_retry_sigma = 0.1;
  double retry_bend = -0.13;
  double enough_sigma = 0.004;
  int max_passes = 6;
  int first_keyframes = 10;
  double growth = 1.3;
  // Sensors are cropped for video and for stabilization.
  double told_sigma = 0.1;
  double max_seconds = 120;

  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
