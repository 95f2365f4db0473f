#include "alidade/tracking/track_failure.h"

namespace alidade {

const char* ReasonText(TrackFailure failure) {
  switch (failure) {
    case TrackFailure::kNone:
      break;
    case TrackFailure::kFirstView:
      return "no earlier image to compare with";
    case TrackFailure::kFewCorners:
      return "too few corners in the image";
    case TrackFailure::kFewMatches:
      return "too few matches between frames";
    case TrackFailure::kLittleMotion:
      return "the camera hardly moves";
    case TrackFailure::kNoMotionModel:
      return "too few matches agree on one camera motion";
    case TrackFailure::kLowParallax:
      return "too little parallax: move the camera sideways";
    case TrackFailure::kPureRotation:
      return "pure rotation: move the camera sideways";
    case TrackFailure::kTwoMotions:
      return "two camera motions fit the matches equally well";
    case TrackFailure::kStillCamera:
      return "only an object moves: move the camera";
    case TrackFailure::kNotConfirmed:
      return "the next frames contradicted the new map";
    case TrackFailure::kMovingStart:
      return "the new map was of a moving object";
    case TrackFailure::kFewDepths:
      return "too few corners with depth in the sensor's range";
    case TrackFailure::kFewNearDepths:
      return "too few corners near enough for accurate depth";
    case TrackFailure::kFewLandmarks:
      return "too few landmarks found";
    case TrackFailure::kNotRecognized:
      return "the place was not recognized";
    case TrackFailure::kUnknownScale:
      return "pure rotation left the scale unknown: move sideways while turning";
    case TrackFailure::kMappingStopped:
      return "mapping has stopped";
  }
  return "";
}

}  // namespace alidade
