// Why a frame has no pose, as a value; the words for it exist once, here.
#pragma once

#include <array>
#include <cstdint>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

enum class TrackFailure : uint8_t {
  kNone,  // the frame has a pose
  // The start of one camera's map (MonoStart), in the order in which a start progresses.
  kFirstView,      // there is no earlier frame to compare with
  kFewCorners,     // too few keypoints in the image
  kFewMatches,     // too few matches with an earlier frame
  kLittleMotion,   // keypoints hardly move
  kNoMotionModel,  // too few matches agree on one motion
  kLowParallax,    // the motion has too little parallax to triangulate
  kPureRotation,   // pure rotation with another focal length or distortion explains the matches
  kTwoMotions,     // two different motions explain the matches equally well
  kStillCamera,    // the background does not move: an object moves in front of a still camera
  kNotConfirmed,   // the frames after the start did not agree with the new map
  kMovingStart,    // the new map was one of a moving object
  // The start of a map with depth.
  kFewDepths,      // too few keypoints with depth within the sensor's range
  kFewNearDepths,  // too few keypoints near enough for the sensor's accuracy
  // A map exists.
  kFewLandmarks,    // too few landmarks of the map were found
  kNotRecognized,   // no known place was recognized
  kUnknownScale,    // a pure rotation left the map without a known scale; it was dropped
  kMappingStopped,  // mapping is off or failed, so no map can be started
};
constexpr int kTrackFailures = 18;

// The reason as the program, files and pages give it; "" for kNone. A literal.
const char* ReasonText(TrackFailure failure);
// What helps against it, as a sentence without the full stop; "" where there is no advice.
const char* AdviceText(TrackFailure failure);
// The name in other languages and files: "few_corners" for kFewCorners; "" for kNone. A literal.
const char* FailureName(TrackFailure failure);
// The failure whose reason is `text`; kNone when there is none.
TrackFailure FailureWithReason(const char* text);

}  // namespace alidade
