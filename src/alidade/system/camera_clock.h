// Checks the time stamps of a camera: a frame follows the last one, is late, comes after a gap, or
// comes from a clock that was set back. Also converts them to a clock that never runs backward.
#pragma once

#include <deque>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct ClockSettings {
  // A pause is a gap when it is longer than both: the motion before says nothing of the place
  // after.
  double gap_seconds = 1;     // seconds; in one a hand turns a camera right round
  double gap_intervals = 10;  // times the usual interval: pictures taken every 2 s have no gaps
  // Frames in a row that are not newer than the last one taken, but in order among themselves, for
  // the clock to be believed to have been set back. Fewer are late ones, or doubles.
  int agree_frames = 3;
  // Seconds a frame may be late where a program plays frames at a rate or from a camera (threaded):
  // then it gives way to a newer one. A quarter of a second still feels live. Slam knows no delay.
  double max_latency = 0.25;
  void Check() const;  // throws Error (usage) naming the field that cannot be
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
