#include "alidade/mapping/settings.h"

#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> MapperSettings::Table() {
  using T = MapperSettings;
  using N = MeasurementNoise;
  constexpr SettingRange kAngle{.min = 0, .max = 90, .open_min = true, .open_max = true};
  static constexpr Setting kRows[] = {
      SameSetting<&T::match_scale>("match_scale", {.min = 0, .max = 4, .open_min = true}),
      ExpertSetting<&T::noise, &N::sigma_px>(
          "noise.mapping_sigma", kPositive, "px",
          "Standard deviation of a keypoint on level 0 in bundle adjustment and loop closure."),
      ExpertSetting<&T::noise, &N::sigma_right_px>("noise.disparity_sigma", kPositive, "px",
                                                   "Standard deviation of a disparity on level 0."),
      ExpertSetting<&T::noise, &N::sensor_noise>("noise.depth_camera", kPositive, "1/m",
                                                 "Depth cameras: the standard deviation of a depth "
                                                 "z is this times z²; 0.003 is a Kinect."),
      ExpertSetting<&T::min_known_scale>("min_known_scale", kNotNegative, "landmarks",
                                         "One camera: landmarks of known scale that fix the scale "
                                         "of a keyframe, or of two maps that "
                                         "are merged."),
      PublicSetting<&T::max_depth_error>(
          "mapper.max_depth_error", kPositive, "",
          "Stereo and RGB-D: relative standard deviation of a depth up to which one view makes a "
          "landmark."),
      PublicSetting<&T::redundant_share>("mapper.redundant_share", kPositive, "",
                                         "A keyframe is removed when more than this share of its "
                                         "landmarks is seen in three others; "
                                         "above 1: none is."),
      PublicSetting<&T::max_keyframes>(
          "mapper.max_keyframes", ZeroOr(AtLeast(10)), "keyframes",
          "Most keyframes in memory, in all maps together; 0: no limit."),
      PublicSetting<&T::window_keyframes>(
          "mapper.window_keyframes", kPositive, "keyframes",
          "Keyframes adjusted after each new one: the newest and its best covisible ones."),
      ExpertSetting<&T::window_fixed>(
          "mapper.window_fixed", kPositive, "keyframes",
          "Keyframes held fixed in that adjustment: those that see most of the same landmarks."),
      ExpertSetting<&T::window_shared>(
          "mapper.window_shared", kPositive, "landmarks",
          "One camera: landmarks that a keyframe must share with one in the window to fill it up."),
      ExpertSetting<&T::window_iterations_mono>("mapper.window_iterations_mono", kPositive, "",
                                                "One camera: most iterations of that adjustment."),
      ExpertSetting<&T::bundle, &BundleSettings::max_iterations>(
          "mapper.bundle.max_iterations", kNotNegative, "",
          "Stereo and RGB-D: most iterations of that adjustment."),
      ExpertSetting<&T::bundle, &BundleSettings::min_relative_decrease>(
          "mapper.bundle.min_relative_decrease", kShareBelowOne, "",
          "It stops when a step lowers the cost by a smaller share."),
      ExpertSetting<&T::min_noise_ratio>("mapper.min_noise_ratio", kPositiveShare, "",
                                         "One camera: smallest ratio of observed to assumed noise "
                                         "for the bound of the robust loss; "
                                         "1: Huber's loss as assumed."),
      ExpertSetting<&T::triangulate_keyframes_mono>(
          "mapper.triangulate_keyframes_mono", kPositive, "keyframes",
          "One camera: covisible keyframes searched for matches to triangulate."),
      ExpertSetting<&T::triangulate_keyframes_depth>("mapper.triangulate_keyframes_depth",
                                                     kNotNegative, "keyframes",
                                                     "The same for stereo and RGB-D."),
      ExpertSetting<&T::triangulate_distance>(
          "mapper.triangulate_distance", FromTo(0, 256), "bits",
          "Largest descriptor distance of a match to triangulate."),
      ExpertSetting<&T::min_parallax_degrees>("mapper.min_parallax_degrees", kAngle, "degrees",
                                              "Stereo and RGB-D: smallest angle between two rays "
                                              "that are triangulated."),
      ExpertSetting<&T::min_parallax_degrees_mono>("mapper.min_parallax_degrees_mono", kAngle,
                                                   "degrees", "The same for one camera."),
      ExpertSetting<&T::min_baseline_ratio>(
          "mapper.min_baseline_ratio", kNotNegative, "",
          "One camera: smallest ratio of baseline to median depth to triangulate."),
      ExpertSetting<&T::max_baseline_error>("mapper.max_baseline_error", kPositive, "",
                                            "One camera: relative standard deviation of the "
                                            "distance of two keyframes above which the "
                                            "scale of what they triangulate is unknown."),
      ExpertSetting<&T::max_unknown_scale_seconds>(
          "mapper.max_unknown_scale_seconds", kNotNegative, "s",
          "One camera: a part mapped without known scale for longer is split off and dropped."),
      ExpertSetting<&T::max_unknown_scale_motion>(
          "mapper.max_unknown_scale_motion", kNotNegative, "",
          "Only when the camera moved by more than this share of the median depth meanwhile."),
      ExpertSetting<&T::rotation_landmarks>(
          "mapper.rotation_landmarks", kNotNegative, "landmarks",
          "One camera: a keyframe with fewer landmarks gets landmarks of assumed depth; 0: never."),
      ExpertSetting<&T::assumed_depth_error>("mapper.assumed_depth_error", kNotNegative, "",
                                             "Relative standard deviation of an assumed depth."),
      ExpertSetting<&T::assumed_depth_degrees>(
          "mapper.assumed_depth_degrees", {.min = 0, .max = 90, .open_max = true}, "degrees",
          "A landmark with less parallax keeps its depth within that standard deviation."),
      ExpertSetting<&T::fuse_keyframes>(
          "mapper.fuse_keyframes", kNotNegative, "keyframes",
          "Covisible keyframes into which landmarks are projected to find duplicates."),
      ExpertSetting<&T::fuse_radius>("mapper.fuse_radius", kPositive, "px",
                                     "Search radius on level 0 for duplicates."),
      ExpertSetting<&T::min_observed_share>(
          "mapper.min_observed_share", kZeroToOne, "",
          "A new landmark is removed below this ratio of found to expected observations."),
      ExpertSetting<&T::trial_keyframes>("mapper.trial_keyframes", kNotNegative, "keyframes",
                                         "Keyframes for which a landmark counts as new."),
  };
  return kRows;
}

void MapperSettings::Check() const {
  CheckRanges(*this);
  bundle.Check();
}

}  // namespace alidade
