// Estimates the rolling-shutter readout time of a camera while its map grows.
#pragma once

#include <array>
#include <mutex>
#include <span>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"
#include "alidade/tracking/readout.h"

namespace ALIDADE_API alidade {

// For cameras whose readout time is not given (`readout` in the camera's file). Rows that are read
// later are seen from a later pose: ignoring 30 ms costs half of the accuracy of hand-held
// recordings (docs/development/decisions/0007-rolling-shutter.md).
struct ReadoutSettings {
  bool enabled = true;
  int first_keyframes = 10;   // of a map, when it is asked first …
  double growth = 1.4;        // … and again when it has so many times as many
  int max_windows = 8;        // stretches of 12 keyframes that are asked, spread over the map
  double prior_sigma = 0.02;  // seconds: what is believed of it beforehand, about none
  int max_iterations = 6;     // of those adjustments: the map is nearly where they end
  double max_sigma = 0.002;   // seconds; what is told worse is not taken …
  double least = 0.004;       // … nor less than this, seconds: it is none, …
  double longest = 0.045;     // … nor more: images come each 33 ms as a rule
  double min_change = 0.001;  // seconds, of what is taken already
  // Maps agree with what they were made with. So frames are asked, too: where they tell of a change
  // of so many seconds at least, to so many at most (one sigma, independent errors), …
  double min_hint = 0.003, hint_sigma = 0.0004;
  // … and the change does away with such a share of the squares of their residuals, …
  double hint_explained = 0.01;
  int hint_frames = 15;  // … so many of them at least, …
  // … and of upright pictures so often on end, the same way. Those are read across: where the
  // camera turns about the upright axis that stretches them sideways, as a map does whose scale
  // drifts.
  int hints_upright = 2;
  double hint_growth = 2;  // … so many times that is taken, since half of it the map hides
  void Check() const;      // throws Error (usage) naming the field that cannot be
};

class ReadoutWatch {
 public:
  ReadoutWatch(const Camera& camera, const MeasurementNoise& noise,
               const ReadoutSettings& settings);

  // Adds the residuals of a tracked frame; see ReadoutSum::Add(). Driving thread.
  void Placed(const Vector6d& motion, std::span<const ReadoutMatch> matches);
  // Call after each mapped keyframe: estimates the readout time from frame residuals, and from the
  // keyframe's map if that has grown enough. True if readout() changed. Mapping thread.
  bool Mapped(KeyFrameId id, const MapSnapshot& map);
  // The map was changed to this camera, readout time included. Not while another call runs.
  void SetCamera(const Camera& camera);
  std::array<double, 2> readout() const;  // see Camera::readout; any thread
  double sigma() const;  // standard deviation, seconds; 0: given, or no estimate. Any thread
  const Camera& camera() const { return camera_; }  // with the readout time; mapping thread

 private:
  bool Take(const std::array<double, 2>& readout, double sigma);
  bool TakeHint();
  bool FramesAgree(const std::array<double, 2>& readout) const;

  Camera camera_;
  MeasurementNoise noise_;
  ReadoutSettings settings_;
  int ask_at_;  // keyframes of the map at the next estimate
  mutable std::mutex mutex_;
  std::array<double, 2> readout_;
  double sigma_ = 0;
  int hints_ = 0;         // consecutive estimates from frames with the same sign
  double last_hint_ = 0;  // change of the readout time in the last one, seconds
  ReadoutSum sum_;
};

}  // namespace alidade
