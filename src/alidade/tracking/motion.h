// How the camera moves from frame to frame: evenly, in time.
#pragma once

#include <deque>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

struct MotionSettings {
  // Seconds a motion is taken to go on at most: nobody moves a camera evenly for longer. (Frames
  // that are further apart as a rule: for one frame.)
  double max_extrapolation = 0.5;
  // Intervals that differ by less than this share count as equal: stamps are given by computers,
  // which are late now and then, exposures by cameras, which are not (TUM fr1: 27 to 40 ms). A
  // frame dropped doubles it.
  double jitter = 0.5;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

class Motion {
 public:
  explicit Motion(const MotionSettings& settings = {}) : settings_(settings) { settings_.Check(); }

  void Clear() { steps_.clear(); }
  bool known() const { return !steps_.empty(); }
  // The last frame's, from the frame before, `seconds` earlier.
  void Add(const Se3& T_now_last, double seconds);
  void Scale(double factor);  // the map's unit has changed
  // T_next_now of the frame `seconds` later; the identity when nothing is known. As the last step
  // when that took as long; else Exp(seconds / s · Log(T)) of the last steps T that took s seconds
  // together, at least as long where so much is known: the noise of a short step is not drawn out.
  Se3 After(double seconds) const;
  // At the last frame, per second: T_camera_world s seconds later is Exp(s v) T_camera_world. The
  // mean of the last step, and half of what changed since the one before; zero when nothing is
  // known.
  Vector6d Velocity() const;

 private:
  MotionSettings settings_;
  struct Step {
    Se3 T_after_before;
    double seconds = 0;
  };
  std::deque<Step> steps_;  // newest first, as far back as max_extrapolation
};

}  // namespace alidade
