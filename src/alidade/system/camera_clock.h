// What the time stamps of a camera say: whether a frame goes on where the last one was, comes late,
// after a gap, or from a clock that was set anew.
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
  kGoesOn,
  kLate,  // not newer than the last frame: not to be taken
  kGap,   // taken; the time has jumped ahead
  kBack   // taken; the time has jumped back
};

class CameraClock {
 public:
  explicit CameraClock(const ClockSettings& settings = {}) : settings_(settings) {}

  ClockStep Take(double time);          // of the next frame, seconds
  void Restart() { started_ = false; }  // the next frame may have any time

  double jump() const { return jump_; }  // between the last two frames taken, seconds
  // A time for the last frame that grows whatever the clock does: what intervals are measured in.
  // Equal to the frame's own until the clock first jumps back.
  double steady() const { return last_ + offset_; }

 private:
  double UsualInterval() const;  // median of the last ones; 0: not known yet

  ClockSettings settings_;
  bool started_ = false, ever_ = false;
  double last_ = 0, offset_ = 0, jump_ = 0;  // seconds
  std::deque<double> intervals_;             // the newest, seconds
  int late_ = 0;                             // frames in a row
  double last_late_ = 0;                     // time of the last of them
};

}  // namespace alidade
