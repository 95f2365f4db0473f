#include "alidade/system/session.h"

#include <limits>

#include "alidade/system/mover_watch.h"
#include "alidade/system/revisit/early_frames.h"
#include "alidade/system/revisit/kept_frames.h"
#include "alidade/system/start/young_map.h"
#include "alidade/tracking/tracker.h"

namespace alidade {
namespace {

using State = SessionState;
using Event = SessionEvent;

// The newest map and everything learned with it.
constexpr Erasure kNewestMap{
    .newest_map = true, .start_views = true, .motion = true, .moving_objects = true};

Transition AfterCut(State state) {
  Erasure erase{.motion = true, .waiting_frames = true, .kept_frames = true};
  switch (state) {
    case State::kSeeking:
      erase.start_views = true;
      return {State::kSeeking, erase};
    case State::kConfirming:
      erase.newest_map = erase.start_views = erase.moving_objects = true;
      return {State::kSeeking, erase};
    case State::kTracking:
      erase.passing_points = true;
      return {State::kLost, erase};
    case State::kLost:
      break;
  }
  return {State::kLost, erase};
}

}  // namespace

Transition After(State state, Event event) {
  switch (event) {
    case Event::kMapLoaded:
      return {State::kLost, {}};
    case Event::kDepthStart:
      return {State::kTracking, {.motion = true}};
    case Event::kTwoViewStart:
      return {State::kConfirming, {}};
    case Event::kMapConfirmed:
      return {State::kTracking, {}};
    case Event::kMapRefused:
      return {State::kSeeking, kNewestMap};
    case Event::kPoseLost:
      if (state == State::kConfirming) return {State::kSeeking, kNewestMap};
      if (state == State::kTracking) return {State::kLost, {.passing_points = true}};
      return {state, {}};
    case Event::kPoseResumed:
      return {State::kTracking, {.start_views = true, .waiting_frames = true}};
    case Event::kRelocalized:
      return {State::kTracking, {.start_views = true, .motion = true, .waiting_frames = true}};
    case Event::kLostForLong:
      return {State::kSeeking, {.start_views = true, .motion = true, .kept_frames = true}};
    case Event::kMapLeft: {
      Erasure erase = state == State::kConfirming ? kNewestMap : Erasure{};
      erase.start_views = erase.motion = erase.waiting_frames = erase.kept_frames = true;
      return {State::kSeeking, erase};
    }
    case Event::kCut:
      return AfterCut(state);
    case Event::kRebuildStarted: {
      Erasure erase = kNewestMap;
      erase.waiting_frames = true;
      return {State::kSeeking, erase};
    }
    case Event::kFrameFailed:
      return {state, {.start_views = true, .dynamics = true}};
  }
  return {state, {}};
}

void Session::Apply(Event event, double time) {
  Transition transition = After(state_, event);
  if (event == Event::kFrameFailed) {
    // A map that the failed frame started has no frame to confirm it.
    transition.erase.newest_map = state_ == State::kConfirming && before_frame_ != state_;
    transition.next = before_frame_;
  }
  if (transition.next == State::kLost && state_ != State::kLost) {
    lost_since_ = event == Event::kMapLoaded ? -std::numeric_limits<double>::infinity() : time;
    informative_frames_ = 0;
  }
  state_ = transition.next;
  const Erasure& erase = transition.erase;
  if (erase.dynamics) memory_.movers.Recover();  // first: it cannot fail
  if (erase.newest_map) {
    memory_.young.Drop();
    memory_.early.Release();  // before waiting_frames, which they are then
    memory_.kept.MapDropped();
  }
  if (erase.start_views) memory_.young.ForgetViews();
  if (erase.motion) memory_.tracker.Forget();
  if (erase.passing_points) memory_.tracker.Lose();
  if (erase.moving_objects) memory_.movers.Forget();
  if (erase.waiting_frames) memory_.early.ForgetWaiting();
  if (erase.kept_frames) memory_.kept.Clear();
}

}  // namespace alidade
