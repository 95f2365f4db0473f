// Checks the time stamps of a camera: a frame follows the last one, is late, comes after a gap, or
// comes from a clock that was set back. Also converts them to a clock that never runs backward.
#pragma once

#include <deque>
#include <span>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in camera_clock.cc.
struct ClockSettings {
  // In one second a hand turns a camera around.
  double gap_seconds = 1;
  // Images taken every 2 s have no gaps.
  double gap_intervals = 10;
  // Consecutive frames older than the last one taken, but in order, after which the clock counts as
  // set back. Fewer are late or duplicate frames.
  int agree_frames = 3;
  // A quarter of a second still feels live.
  double max_latency = 0.25;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

enum class ClockStep {
  kGoesOn,  // accepted; continues the last frame
  kLate,    // not accepted: not newer than the last accepted frame
  kGap,     // accepted; the time jumped ahead
  kBack     // accepted; the clock was set back (ClockSettings::agree_frames)
};

class CameraClock {
 public:
  explicit CameraClock(const ClockSettings& settings = {}) : settings_(settings) {}

  ClockStep Take(double time);          // the next frame's time, seconds
  void Restart() { started_ = false; }  // the next frame may have any time

  double jump() const { return jump_; }  // time between the last two accepted frames, seconds
  // Time of the last accepted frame on a clock that never runs backward, seconds; time spans such
  // as "lost for one second" are measured on it. Equal to the frame's own time until the clock is
  // first set back or restarted.
  double steady() const { return last_ + offset_; }

 private:
  double UsualInterval() const;  // median of the newest intervals, seconds; 0: not known yet

  ClockSettings settings_;
  bool started_ = false, ever_ = false;      // a frame was accepted since Restart(), and at all
  double last_ = 0, offset_ = 0, jump_ = 0;  // seconds; last_: time of the last accepted frame
  std::deque<double> intervals_;             // the newest, seconds
  int late_ = 0;                             // consecutive late frames with increasing times
  double last_late_ = 0;                     // time of the last of them, seconds
};

}  // namespace alidade
