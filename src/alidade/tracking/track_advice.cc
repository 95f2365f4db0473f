// Advice of track_failure.h. A file of its own, so that the core for browsers does not link it.
#include <cstring>

#include "alidade/tracking/track_failure.h"

namespace alidade {

const char* AdviceText(TrackFailure failure) {
  switch (failure) {
    case TrackFailure::kFewCorners:
      return "Turning to something with structure helps";
    case TrackFailure::kFewMatches:
      return "Moving more slowly helps";
    case TrackFailure::kLittleMotion:
      return "Moving the camera sideways helps";
    case TrackFailure::kNoMotionModel:
      return "Something in view moves by itself: looking elsewhere, or --dynamics geometry, helps";
    case TrackFailure::kLowParallax:
      return "Turning alone shows no depth";
    case TrackFailure::kPureRotation:
      return "Turning alone shows no depth";
    case TrackFailure::kTwoMotions:
      return "Looking at more than one flat wall, and moving on, helps";
    case TrackFailure::kStillCamera:
      return "The camera itself has to move";
    case TrackFailure::kNotConfirmed:
      return "Moving on, sideways, helps";
    case TrackFailure::kMovingStart:
      return "Looking where nothing moves helps";
    case TrackFailure::kFewDepths:
      return "Going nearer, to something with structure, helps";
    case TrackFailure::kFewNearDepths:
      return "Going nearer, to something with structure, helps";
    case TrackFailure::kMappingStopped:
      return "A part of the program failed: see the warnings";
    case TrackFailure::kNone:
    case TrackFailure::kFirstView:
    case TrackFailure::kFewLandmarks:
    case TrackFailure::kNotRecognized:
    case TrackFailure::kUnknownScale:
      break;
  }
  return "";
}

TrackFailure FailureWithReason(const char* text) {
  for (int i = 1; i < kTrackFailures; ++i) {
    const auto failure = static_cast<TrackFailure>(i);
    if (std::strcmp(ReasonText(failure), text) == 0) return failure;
  }
  return TrackFailure::kNone;
}

}  // namespace alidade
