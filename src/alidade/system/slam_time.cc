// Time that jumps, and recordings that end: the next frame need not go on where the last one was.
#include <cmath>
#include <cstdio>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/system/slam_impl.h"

namespace alidade {
namespace {

// The first time; how often it happened is counted.
void WarnOfJump(double seconds) {
  char text[100];
  std::snprintf(text, sizeof(text),
                "the time jumps %s by %.1f s: taken as a cut (further ones are not told)",
                seconds < 0 ? "back" : "ahead", std::abs(seconds));
  LogWarning(text);
}

}  // namespace

// What the time of the next frame says: why it does not go on where the last one was; "" when it
// does. Throws when it is not to be taken.
const char* Slam::Impl::Tick(double time) {
  const double before = log_.empty() ? time : log_.time();
  switch (clock_.Take(time)) {
    case ClockStep::kGoesOn:
      return std::exchange(restarted_, false) ? "a new recording" : "";
    case ClockStep::kLate:
      ThrowInput("the frame's time does not grow");
    case ClockStep::kGap:
      Cut();
      if (!std::exchange(jump_told_, true)) WarnOfJump(time - before);
      return "after a gap in time";
    case ClockStep::kBack:
      Cut();
      log_.BeginRecording();
      workers_.BeginRecording();
      if (!std::exchange(jump_told_, true)) WarnOfJump(time - before);
      return "the clock was set back";
  }
  return "";
}

// The next frame may show anything: nothing is taken from the last one.
void Slam::Impl::Cut() {
  ++cuts_;
  kept_.clear();
  early_.ForgetWaiting();
  if (young_.on_trial()) {
    GiveUpStart("");
  } else if (state_ == TrackState::kTracking) {
    Lose();
  } else if (state_ == TrackState::kInitialising) {
    young_.Reset();
  }
  tracker_.Forget();
}

void Slam::Impl::Reset() {
  const std::lock_guard<std::mutex> driving(driving_);
  if (log_.empty() || restarted_) return;
  Cut();
  clock_.Restart();
  log_.BeginRecording();
  workers_.BeginRecording();
  restarted_ = true;
}

}  // namespace alidade
