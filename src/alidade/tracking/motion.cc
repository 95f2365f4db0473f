#include "alidade/tracking/motion.h"

#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> MotionSettings::Table() {
  static constexpr Setting kRows[] = {
      ExpertSetting<&MotionSettings::max_extrapolation>(
          "tracker.max_extrapolation", kPositive, "s",
          "Longest time for which a motion is assumed to continue."),
  };
  return kRows;
}

void MotionSettings::Check() const {
  CheckRanges(*this);
  if (!(jitter >= 0)) ThrowUsage("MotionSettings::jitter must not be negative");
}

void Motion::Add(const Se3& T_now_last, double seconds) {
  steps_.push_front({T_now_last, seconds});
  double known = 0;
  size_t needed = 0;
  while (needed < steps_.size() && known < settings_.max_extrapolation)
    known += steps_[needed++].seconds;
  steps_.resize(std::max<size_t>(needed, 1));
}

void Motion::Scale(double factor) {
  for (Step& step : steps_) step.T_after_before.t *= factor;
}

Se3 Motion::After(double seconds) const {
  if (steps_.empty()) return {};
  const Step& last = steps_.front();
  if (!(seconds > 0 && last.seconds > 0)) return last.T_after_before;
  seconds = std::min(seconds, std::max(last.seconds, settings_.max_extrapolation));
  if (std::max(seconds / last.seconds, last.seconds / seconds) <= 1 + settings_.jitter)
    return last.T_after_before;
  Step all = last;
  for (size_t i = 1; i < steps_.size() && all.seconds < seconds; ++i) {
    all.T_after_before = all.T_after_before * steps_[i].T_after_before;
    all.seconds += steps_[i].seconds;
  }
  return Se3::Exp(seconds / all.seconds * all.T_after_before.Log());
}

Vector6d Motion::Velocity() const {
  if (steps_.empty() || !(steps_[0].seconds > 0)) return Vector6d::Zero();
  const Vector6d last = steps_[0].T_after_before.Log() / steps_[0].seconds;
  if (steps_.size() < 2 || !(steps_[1].seconds > 0)) return last;
  const Vector6d before = steps_[1].T_after_before.Log() / steps_[1].seconds;
  // Means over two intervals are velocities at their midpoints, (a + b) / 2 apart; the end of the
  // last interval is a / 2 after its midpoint.
  const double a = steps_[0].seconds, b = steps_[1].seconds;
  return last + (last - before) * a / (a + b);
}

}  // namespace alidade
