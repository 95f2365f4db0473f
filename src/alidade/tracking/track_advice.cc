// Advice of track_failure.h. A file of its own, so that the core for browsers does not link it.
#include <array>
#include <cstring>

#include "alidade/tracking/track_failure.h"

namespace alidade {

const char* AdviceText(TrackFailure failure) {
  switch (failure) {
    case TrackFailure::kFewCorners:
      return "Point the camera at something with texture";
    case TrackFailure::kFewMatches:
      return "Move the camera more slowly";
    case TrackFailure::kLittleMotion:
      return "Move the camera sideways";
    case TrackFailure::kNoMotionModel:
      return "Something in view moves: point the camera elsewhere, or use --dynamics geometry";
    case TrackFailure::kLowParallax:
      return "Rotation alone gives no depth";
    case TrackFailure::kPureRotation:
      return "Rotation alone gives no depth";
    case TrackFailure::kTwoMotions:
      return "Keep moving, with more than one flat surface in view";
    case TrackFailure::kStillCamera:
      return "The camera itself has to move";
    case TrackFailure::kNotConfirmed:
      return "Keep moving sideways";
    case TrackFailure::kMovingStart:
      return "Point the camera at things that do not move";
    case TrackFailure::kFewDepths:
      return "Move closer to something with texture";
    case TrackFailure::kFewNearDepths:
      return "Move closer to something with texture";
    case TrackFailure::kMappingStopped:
      return "Mapping is switched off, or a part of the program failed: see the warnings";
    case TrackFailure::kNone:
    case TrackFailure::kFirstView:
    case TrackFailure::kFewLandmarks:
    case TrackFailure::kNotRecognized:
    case TrackFailure::kUnknownScale:
      break;
  }
  return "";
}

const char* FailureName(TrackFailure failure) {
  constexpr std::array<const char*, kTrackFailures> kNames = {"",
                                                              "first_view",
                                                              "few_corners",
                                                              "few_matches",
                                                              "little_motion",
                                                              "no_motion_model",
                                                              "low_parallax",
                                                              "pure_rotation",
                                                              "two_motions",
                                                              "still_camera",
                                                              "not_confirmed",
                                                              "moving_start",
                                                              "few_depths",
                                                              "few_near_depths",
                                                              "few_landmarks",
                                                              "not_recognized",
                                                              "unknown_scale",
                                                              "mapping_stopped"};
  const auto index = static_cast<size_t>(failure);
  return index < kNames.size() ? kNames[index] : "";
}

TrackFailure FailureWithReason(const char* text) {
  for (int i = 1; i < kTrackFailures; ++i) {
    const auto failure = static_cast<TrackFailure>(i);
    if (std::strcmp(ReasonText(failure), text) == 0) return failure;
  }
  return TrackFailure::kNone;
}

}  // namespace alidade
