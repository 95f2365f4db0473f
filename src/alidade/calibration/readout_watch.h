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

struct Setting;

// Range, unit and meaning: Table() in readout_watch.cc.
struct ReadoutSettings {
  bool enabled = true;
  int first_keyframes = 10;
  double growth = 1.4;
  int max_windows = 8;
  // Phones and webcams take 10 to 30 ms, others none.
  double prior_sigma = 0.02;
  // The map is close to where they converge.
  int max_iterations = 6;
  double max_sigma = 0.002;
  double least = 0.004;
  // Images usually come every 33 ms.
  double longest = 0.045;
  double min_change = 0.001;
  // A map agrees with the readout time it was made with, so frames are asked, too.
  double min_hint = 0.003;
  double hint_sigma = 0.0004;
  double hint_explained = 0.01;
  int hint_frames = 15;
  // Upright images are read across: rotation about the vertical axis stretches them sideways, as a
  // drift of scale stretches a map.
  int hints_upright = 2;
  double hint_growth = 2;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
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
