#include "alidade/tracking/track_failure.h"

#include <cstring>

namespace alidade {
namespace {

struct Words {
  const char* reason;
  const char* advice;
};

Words WordsFor(TrackFailure failure) {
  switch (failure) {
    case TrackFailure::kNone:
      break;
    case TrackFailure::kFirstView:
      return {"no frame yet", ""};
    case TrackFailure::kFewCorners:
      return {"too few corners in the image", "Turning to something with structure helps"};
    case TrackFailure::kFewMatches:
      return {"too few matches between frames", "Moving more slowly helps"};
    case TrackFailure::kLittleMotion:
      return {"the camera hardly moves", "Moving the camera sideways helps"};
    case TrackFailure::kNoMotionModel:
      return {
          "too few points agree on one motion",
          "Something in view moves by itself: looking elsewhere, or --dynamics geometry, helps"};
    case TrackFailure::kLowParallax:
      return {"too little parallax: move the camera sideways", "Turning alone shows no depth"};
    case TrackFailure::kPureRotation:
      return {"a turn on the spot explains what is seen: move the camera sideways",
              "Turning alone shows no depth"};
    case TrackFailure::kTwoMotions:
      return {"two motions explain what is seen",
              "Looking at more than one flat wall, and moving on, helps"};
    case TrackFailure::kStillCamera:
      return {"something moves, the camera seems to stand still", "The camera itself has to move"};
    case TrackFailure::kNotConfirmed:
      return {"the first points did not hold", "Moving on, sideways, helps"};
    case TrackFailure::kMovingStart:
      return {"the first points moved", "Looking where nothing moves helps"};
    case TrackFailure::kFewDepths:
      return {"too few corners with depth in the sensor's range",
              "Going nearer, to something with structure, helps"};
    case TrackFailure::kFewNearDepths:
      return {"too few corners near enough for the sensor to place",
              "Going nearer, to something with structure, helps"};
    case TrackFailure::kFewLandmarks:
      return {"too few landmarks found", ""};
    case TrackFailure::kNotRecognized:
      return {"the place was not recognised", ""};
    case TrackFailure::kUnknownScale:
      return {"a turn left no scale: move sideways while turning", ""};
    case TrackFailure::kMappingStopped:
      return {"mapping has stopped", "A part of the program failed: see the warnings"};
  }
  return {"", ""};
}

}  // namespace

const char* ReasonText(TrackFailure failure) { return WordsFor(failure).reason; }
const char* AdviceText(TrackFailure failure) { return WordsFor(failure).advice; }

TrackFailure FailureWithReason(const char* text) {
  for (int i = 1; i < kTrackFailures; ++i) {
    const auto failure = static_cast<TrackFailure>(i);
    if (std::strcmp(ReasonText(failure), text) == 0) return failure;
  }
  return TrackFailure::kNone;
}

}  // namespace alidade
