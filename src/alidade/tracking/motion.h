// Constant-velocity motion model, based on time stamps.
#pragma once

#include <deque>
#include <span>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in motion.cc.
struct MotionSettings {
  // Hands do not move a camera evenly for longer. Where frames are further apart: one interval.
  double max_extrapolation = 0.5;
  // Intervals whose ratio is below 1 + jitter count as equal: stamps given by a computer are
  // sometimes late, exposures are not. A dropped frame doubles the interval.
  double jitter = 0.5;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

class Motion {
 public:
  explicit Motion(const MotionSettings& settings = {}) : settings_(settings) { settings_.Check(); }

  void Clear() { steps_.clear(); }
  bool known() const { return !steps_.empty(); }
  // Adds the motion from the previous to the current frame, `seconds` apart.
  void Add(const Se3& T_now_last, double seconds);
  void Scale(double factor);  // factor of a change of the map's scale
  // T_next_now for a frame `seconds` later; identity if no motion is known. The last step if that
  // took as long. Otherwise Exp(seconds / s · Log(T)) of the last steps T that took s seconds in
  // total, with s at least `seconds` if known, so that the noise of a short step is not
  // extrapolated.
  Se3 After(double seconds) const;
  // Velocity at the last frame: T_camera_world s seconds later is Exp(s v) T_camera_world. The mean
  // velocity of the last step, extrapolated to its end with the change since the step before; zero
  // if no motion is known. Map units and radians per second.
  Vector6d Velocity() const;

 private:
  MotionSettings settings_;
  struct Step {
    Se3 T_after_before;
    double seconds = 0;
  };
  std::deque<Step> steps_;  // newest first, back to max_extrapolation
};

}  // namespace alidade
