#include "alidade/system/camera/camera_clock.h"

#include <algorithm>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/median.h"
#include "alidade/base/settings_table.h"

namespace alidade {
namespace {

// Intervals whose median is the usual one. Up to four of them may be longer because frames were
// dropped.
constexpr size_t kIntervals = 9;
constexpr size_t kFewestIntervals = 3;  // with fewer there is no usual interval

}  // namespace

std::span<const Setting> ClockSettings::Table() {
  using T = ClockSettings;
  static constexpr Setting kRows[] = {
      PublicSetting<&T::gap_seconds>(
          "time.gap_seconds", kPositive, "s",
          "A longer pause between frames is a gap: the motion before it is not extrapolated."),
      PublicSetting<&T::max_latency>(
          "time.max_latency", kNotNegative, "s",
          "Live and real-time runs skip frames that would be processed later than this."),
      ExpertSetting<&T::gap_intervals>("time.gap_intervals", AtLeast(1), "",
                                       "A gap is also longer than this times the usual interval."),
  };
  return kRows;
}

void ClockSettings::Check() const { CheckRanges(*this); }

double CameraClock::UsualInterval() const {
  if (intervals_.size() < kFewestIntervals) return 0;
  std::vector<double> sorted(intervals_.begin(), intervals_.end());
  return UpperMedian(sorted);
}

ClockStep CameraClock::Take(double time) {
  const double usual = UsualInterval();
  ClockStep step = ClockStep::kGoesOn;
  if (!started_) {
    if (ever_) offset_ += last_ - time + usual;
    started_ = ever_ = true;
  } else if (time > last_) {
    jump_ = time - last_;
    if (usual > 0 && jump_ > std::max(settings_.gap_seconds, settings_.gap_intervals * usual)) {
      step = ClockStep::kGap;
    } else {
      intervals_.push_back(jump_);
      if (intervals_.size() > kIntervals) intervals_.pop_front();
    }
  } else {
    late_ = late_ > 0 && time > last_late_ ? late_ + 1 : 1;
    last_late_ = time;
    if (late_ < settings_.agree_frames) return ClockStep::kLate;
    jump_ = time - last_;
    offset_ += usual - jump_;
    step = ClockStep::kBack;
  }
  late_ = 0;
  last_ = time;
  return step;
}

}  // namespace alidade
