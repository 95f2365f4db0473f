#include "alidade/tracking/settings.h"

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> TrackerSettings::Table() {
  using T = TrackerSettings;
  using N = MeasurementNoise;
  static constexpr Setting kRows[] = {
      ExpertSetting<&T::match_scale>(
          "match_scale", {.min = 0, .max = 4, .open_min = true}, "",
          "Multiplies the required counts of matches, which are given for 1000 features."),
      ExpertSetting<&T::noise, &N::sigma_px>(
          "noise.tracking_sigma", kPositive, "px",
          "Standard deviation of a keypoint on level 0 in pose estimation."),
      SameSetting<&T::noise, &N::sigma_right_px>("noise.disparity_sigma", kPositive),
      PublicSetting<&T::min_tracked>("tracker.min_tracked", AtLeast(6), "inliers",
                                     "A frame with fewer landmarks of the local map is lost."),
      PublicSetting<&T::predict_seconds>(
          "tracker.predict_seconds", kNotNegative, "s",
          "How long the pose of a lost camera is still predicted from its motion."),
      PublicSetting<&T::depth_range>("tracker.depth_range", kPositive, "m",
                                     "Readings of a depth camera beyond this are ignored."),
      PublicSetting<&T::keyframe_share_mono>("tracker.keyframe_share_mono", kPositive, "",
                                             "One camera: a new keyframe when inliers fall below "
                                             "this share of their maximum since the "
                                             "last one."),
      PublicSetting<&T::keyframe_share_depth>(
          "tracker.keyframe_share_depth", kPositive, "",
          "Stereo and RGB-D: a new keyframe when inliers fall below this share of their maximum "
          "since the last one."),
      ExpertSetting<&T::align>(
          "tracker.align", kOnOff, "",
          "Between keyframes, landmarks are aligned with the image instead of extracting features; "
          "off: features are extracted from every frame."),
      PublicSetting<&T::min_keyframe_gap>("tracker.min_keyframe_gap", kNotNegative, "frames",
                                          "Fewest frames between two keyframes."),
      PublicSetting<&T::max_keyframe_gap>("tracker.max_keyframe_gap", kPositive, "frames",
                                          "Most frames between two keyframes."),
      ExpertSetting<&T::min_predicted>(
          "tracker.min_predicted", kPositive, "matches",
          "With fewer matches with the last frame, the search radius is doubled."),
      ExpertSetting<&T::min_after_prediction>(
          "tracker.min_after_prediction", AtLeast(4), "inliers",
          "With fewer inliers after the prediction, the reference keyframe is tried."),
      ExpertSetting<&T::min_inlier_share>(
          "tracker.min_inlier_share", kShareBelowOne, "",
          "A frame is lost below this ratio of inliers to landmarks expected in view."),
      ExpertSetting<&T::unconfirmed_frames>(
          "tracker.unconfirmed_frames", kNotNegative, "frames",
          "Stereo and RGB-D: frames after a start or relocalization whose predicted motion is "
          "compared with a search over the whole image."),
      ExpertSetting<&T::max_motion_age>(
          "tracker.max_motion_age", kNotNegative, "s",
          "After a longer time without a pose, the predicted motion is not trusted."),
      ExpertSetting<&T::min_agreement>("tracker.min_agreement", kShareBelowOne, "",
                                       "Share of a frame's matches that must fit one pose."),
      ExpertSetting<&T::max_distance>(
          "tracker.max_distance", FromTo(1, 256), "bits",
          "Largest descriptor distance of a match when a pose guides the search."),
      ExpertSetting<&T::last_frame_radius>("tracker.last_frame_radius", kPositive, "px",
                                           "One camera: search radius on level 0 around the "
                                           "position predicted from the last frame."),
      ExpertSetting<&T::last_frame_radius_depth>("tracker.last_frame_radius_depth", kPositive, "px",
                                                 "The same for stereo and RGB-D."),
      ExpertSetting<&T::local_radius>(
          "tracker.local_radius", kPositive, "px",
          "One camera: search radius on level 0 around a projected landmark."),
      ExpertSetting<&T::local_radius_depth>("tracker.local_radius_depth", kPositive, "px",
                                            "The same for stereo and RGB-D."),
      ExpertSetting<&T::local_keyframes>("tracker.local_keyframes", kPositive, "keyframes",
                                         "Most keyframes in the local map."),
      ExpertSetting<&T::min_relocalized_spread>(
          "tracker.min_relocalized_spread", {.min = 0, .max = 0.5, .open_max = true}, "",
          "Root mean square distance of the landmarks of a relocalization from their center, as a "
          "share of the image diagonal."),
  };
  return kRows;
}

void TrackerSettings::Check() const {
  extractor.Check();
  motion.Check();
  CheckRanges(evidence);
  CheckRanges(*this);
  if (max_keyframe_gap <= min_keyframe_gap)
    ThrowUsage("setting tracker.max_keyframe_gap must exceed tracker.min_keyframe_gap");
}

}  // namespace alidade
