#include "alidade/looping/settings.h"

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> LoopSettings::Table() {
  using T = LoopSettings;
  using N = MeasurementNoise;
  static constexpr Setting kRows[] = {
      SameSetting<&T::match_scale>("match_scale", {.min = 0, .max = 4, .open_min = true}),
      SameSetting<&T::noise, &N::sigma_px>("noise.mapping_sigma", kPositive),
      SameSetting<&T::noise, &N::sigma_right_px>("noise.disparity_sigma", kPositive),
      SameSetting<&T::min_known_scale>("min_known_scale", kNotNegative),
      PublicSetting<&T::enabled>("loop.enabled", kOnOff, "",
                                 "Close loops and merge maps; 0: places are only recognized to "
                                 "relocalize."),
      PublicSetting<&T::min_matches>(
          "loop.min_matches", kPositive, "matches",
          "Matches by descriptors alone that a candidate place must have."),
      PublicSetting<&T::min_found>(
          "loop.min_found", AtLeast(10), "landmarks",
          "Landmarks of the old place that must be found after alignment to close a loop."),
      PublicSetting<&T::min_merge_found>("loop.min_merge_found", AtLeast(10), "landmarks",
                                         "As loop.min_found, to merge two maps."),
      PublicSetting<&T::min_merge_alike>(
          "loop.min_merge_alike", kZeroToOne, "",
          "Share of them whose descriptors must match to merge two maps; more keeps similar rooms "
          "apart."),
      PublicSetting<&T::max_drift>(
          "loop.max_drift", kPositive, "",
          "Largest correction by a loop, as a share of the path since the place was last seen."),
      ExpertSetting<&T::candidates>("loop.candidates", FromTo(1, 10), "places",
                                    "Most places verified for each keyframe in each map."),
      ExpertSetting<&T::score_share>(
          "loop.score_share", kZeroToOne, "",
          "A candidate must be at least this similar, relative to the best covisible keyframe."),
      ExpertSetting<&T::tied_share>("loop.tied_share", kZeroToOne, "",
                                    "One camera: neighbors that share this share of a keyframe's "
                                    "landmarks, and theirs, are no "
                                    "candidates."),
      ExpertSetting<&T::max_view_turn>(
          "loop.max_view_turn", kPositive, "rad",
          "Largest angle between the optical axes of a keyframe and a candidate of the same map."),
      ExpertSetting<&T::min_aligned>("loop.min_aligned", AtLeast(3), "matches",
                                     "Matches that must agree on one alignment."),
      ExpertSetting<&T::min_visible_share>(
          "loop.min_visible_share", kZeroToOne, "",
          "Share of the landmarks expected in view that must be found to close a loop."),
      ExpertSetting<&T::search_radius>(
          "loop.search_radius", kPositive, "px",
          "Search radius on level 0 around a landmark after alignment; the second pass uses half."),
      ExpertSetting<&T::max_distance>("loop.max_distance", FromTo(1, 256), "bits",
                                      "Largest descriptor distance of a match."),
      ExpertSetting<&T::confirm_keyframes>(
          "loop.confirm_keyframes", kNotNegative, "keyframes",
          "Covisible keyframes in which a loop is verified as well."),
      ExpertSetting<&T::confirm_needed>("loop.confirm_needed", kNotNegative, "keyframes",
                                        "How many of them must confirm it."),
      ExpertSetting<&T::max_turn>("loop.max_turn", kPositive, "rad",
                                  "Largest rotation by which a loop may correct."),
      ExpertSetting<&T::turn_drift>("loop.turn_drift", kNotNegative, "",
                                    "It may be at most this share of the rotation since the place "
                                    "was seen, plus 0.1 rad. Where "
                                    "the focal length is assumed: 0.6."),
      ExpertSetting<&T::max_scale>(
          "loop.max_scale", AtLeast(1), "",
          "One camera: largest ratio of scales between the old and the new place."),
      ExpertSetting<&T::graph_shared>(
          "loop.graph_shared", kPositive, "landmarks",
          "Landmarks two keyframes must share to be connected in the pose graph."),
      ExpertSetting<&T::graph, &PoseGraphSettings::max_iterations>(
          "loop.graph.max_iterations", kNotNegative, "", "Most iterations of the pose graph."),
      ExpertSetting<&T::bundle, &BundleSettings::max_iterations>(
          "loop.bundle.max_iterations", kNotNegative, "",
          "Most iterations of the adjustment of the whole map after a loop."),
  };
  return kRows;
}

void LoopSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("setting ") + what);
  };
  CheckRanges(*this);
  require(min_matches >= min_aligned, "loop.min_matches must be at least expert.loop.min_aligned");
  require(min_merge_found >= min_found, "loop.min_merge_found must be at least loop.min_found");
  require(confirm_keyframes >= confirm_needed,
          "expert.loop.confirm_keyframes must be at least expert.loop.confirm_needed");
  reach.Check();
  graph.Check();
  bundle.Check();
}

}  // namespace alidade
