#include "alidade/tracking/track_failure.h"

namespace alidade {

const char* ReasonText(TrackFailure failure) {
  switch (failure) {
    case TrackFailure::kNone:
      break;
    case TrackFailure::kFirstView:
      return "no frame yet";
    case TrackFailure::kFewCorners:
      return "too few corners in the image";
    case TrackFailure::kFewMatches:
      return "too few matches between frames";
    case TrackFailure::kLittleMotion:
      return "the camera hardly moves";
    case TrackFailure::kNoMotionModel:
      return "too few points agree on one motion";
    case TrackFailure::kLowParallax:
      return "too little parallax: move the camera sideways";
    case TrackFailure::kPureRotation:
      return "a turn on the spot explains what is seen: move the camera sideways";
    case TrackFailure::kTwoMotions:
      return "two motions explain what is seen";
    case TrackFailure::kStillCamera:
      return "something moves, the camera seems to stand still";
    case TrackFailure::kNotConfirmed:
      return "the first points did not hold";
    case TrackFailure::kMovingStart:
      return "the first points moved";
    case TrackFailure::kFewDepths:
      return "too few corners with depth in the sensor's range";
    case TrackFailure::kFewNearDepths:
      return "too few corners near enough for the sensor to place";
    case TrackFailure::kFewLandmarks:
      return "too few landmarks found";
    case TrackFailure::kNotRecognized:
      return "the place was not recognized";
    case TrackFailure::kUnknownScale:
      return "a turn left no scale: move sideways while turning";
    case TrackFailure::kMappingStopped:
      return "mapping has stopped";
  }
  return "";
}

}  // namespace alidade
