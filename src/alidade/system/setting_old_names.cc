#include "alidade/system/setting_old_names.h"

#include <string_view>

namespace alidade {
namespace {

constexpr struct {
  std::string_view before, now;
} kRenamed[] = {
    {"calibrate.centre_sigma", "calibrate.center_sigma"},
    {"calibrate.first_keyframes", "camera.first_keyframes"},
    {"calibrate.focal_sigma", "camera.focal_sigma"},
    {"calibrate.growth", "camera.growth"},
    {"calibrate.readout_sigma", "camera.readout_sigma"},
    {"early.most", "early.max_frames"},
    {"early.most_missed", "early.max_missed_frames"},
    {"early.settle", "early.settle_frames"},
    {"look.dark", "look.min_brightness"},
    {"loop.match_scale", "match_scale"},
    {"loop.min_found_share", "loop.min_visible_share"},
    {"loop.min_known_scale", "min_known_scale"},
    {"loop.sigma_px", "noise.mapping_sigma"},
    {"loop.sigma_right_px", "noise.disparity_sigma"},
    {"mapper.least_noise", "mapper.min_noise_ratio"},
    {"mapper.match_scale", "match_scale"},
    {"mapper.min_found_share", "mapper.min_observed_share"},
    {"mapper.min_known_scale", "min_known_scale"},
    {"mapper.sensor_noise", "noise.depth_camera"},
    {"mapper.sigma_px", "noise.mapping_sigma"},
    {"mapper.sigma_right_px", "noise.disparity_sigma"},
    {"mapper.turn_landmarks", "mapper.rotation_landmarks"},
    {"readout.first_keyframes", "camera.first_keyframes"},
    {"refine.first_keyframes", "camera.first_keyframes"},
    {"refine.focal_sigma", "camera.focal_sigma"},
    {"refine.growth", "camera.growth"},
    {"refine.readout_sigma", "camera.readout_sigma"},
    {"start.match_scale", "match_scale"},
    {"stream.waiting", "stream.max_waiting"},
    {"tracker.extractor.fast_minimum", "tracker.extractor.min_fast_threshold"},
    {"tracker.keyframe_max_gap", "tracker.max_keyframe_gap"},
    {"tracker.keyframe_min_gap", "tracker.min_keyframe_gap"},
    {"tracker.match_scale", "match_scale"},
    {"tracker.min_found_share", "tracker.min_inlier_share"},
    {"tracker.min_relocalised_spread", "tracker.min_relocalized_spread"},
    {"tracker.sigma_px", "noise.tracking_sigma"},
    {"tracker.sigma_right_px", "noise.disparity_sigma"},
    {"tracker.unproven_frames", "tracker.unconfirmed_frames"},
    {"tracker.unproven_seconds", "tracker.max_motion_age"},
};

// They have no name any more; separated and surrounded by spaces. Not in alidade.wasm, whose size
// is limited: no page has ever set them.
#ifndef __EMSCRIPTEN__
constexpr std::string_view kDropped =
    " "
    "dynamics.box.island_before dynamics.box.island_behind dynamics.box.known_static "
    "dynamics.box.middle dynamics.box.min_reach dynamics.box.most_still "
    "dynamics.box.oval dynamics.box.reach dynamics.box.rim dynamics.box.seed "
    "dynamics.box.seed_middle dynamics.box.step dynamics.box.widen "
    "dynamics.depth.free_neighbours dynamics.depth.free_tolerances "
    "dynamics.depth.min_readings dynamics.depth.spread_step "
    "dynamics.depth.spread_unmeasured dynamics.depth.stereo_nearest "
    "dynamics.depth.stereo_texture dynamics.depth.stereo_uniqueness "
    "dynamics.depth.stereo_window dynamics.depth.tolerance_linear "
    "dynamics.depth.tolerance_square dynamics.features.enough_count "
    "dynamics.features.far_cells dynamics.features.reading_reach dynamics.features.sure "
    "dynamics.features.surface dynamics.history.older dynamics.history.recent "
    "dynamics.history.step dynamics.landmarks.found dynamics.landmarks.gone "
    "dynamics.landmarks.hidden_found dynamics.landmarks.min_neighbours "
    "dynamics.landmarks.most_on_movers dynamics.landmarks.on_mover "
    "dynamics.objects.carried_share dynamics.objects.flow_middle "
    "dynamics.objects.flow_tracks dynamics.objects.moved dynamics.objects.moves_share "
    "dynamics.objects.rest_tracks dynamics.objects.rested dynamics.objects.rests_share "
    "dynamics.objects.same_overlap dynamics.surfaces.compare_far "
    "dynamics.surfaces.compare_near dynamics.surfaces.confirmed "
    "dynamics.surfaces.flow_moved dynamics.surfaces.flow_stood "
    "dynamics.surfaces.flow_stood_weight dynamics.surfaces.free dynamics.surfaces.gap "
    "dynamics.surfaces.learn dynamics.surfaces.remember dynamics.surfaces.rested "
    "dynamics.surfaces.same dynamics.surfaces.settled dynamics.surfaces.spread_fade "
    "dynamics.surfaces.spread_heard dynamics.surfaces.spread_least "
    "dynamics.surfaces.spread_rate dynamics.surfaces.trusted dynamics.surfaces.young "
    "dynamics.tracks.fade dynamics.tracks.forget dynamics.tracks.least "
    "dynamics.tracks.most dynamics.tracks.moved dynamics.tracks.proven "
    "dynamics.tracks.stood dynamics.votes.agreement_ago "
    "dynamics.votes.agreement_iterations dynamics.votes.agreement_share "
    "dynamics.votes.agreement_tracks dynamics.votes.consensus_reach "
    "dynamics.votes.consensus_tracks dynamics.votes.depth_noise "
    "dynamics.votes.homography_share dynamics.votes.least_ago dynamics.votes.measured_px "
    "dynamics.votes.measured_share dynamics.votes.most_ago dynamics.votes.rival_block "
    "dynamics.votes.rival_blocks early.leap_seconds lens.max_windows loop.alike_radius "
    "loop.bundle.min_relative_decrease loop.confirm_found loop.graph.length_scale "
    "loop.group loop.max_drift_floor loop.max_plain_scale loop.reach.elsewhere_share "
    "loop.reach.floor loop.reach.plain_alike loop.reach.plain_share loop.reach.span "
    "mapper.enough_known_scale mapper.fuse_distance mapper.triangulate_ratio "
    "mapper.turn_radius places.match_level places.match_max_distance places.match_ratio "
    "places.min_split places.rounds places.sample semidense.chi2_check "
    "semidense.chi2_pair semidense.gradient_weight semidense.line_sigma "
    "start.min_beyond_lens start.min_motion start.min_still_area start.min_still_peak "
    "start.references start.still_memory start.still_pixels start.turn_sigma "
    "time.agree_frames tracker.bad_frame_sigma tracker.good_agreement "
    "tracker.cut_inlier_share tracker.local_ratio "
    "tracker.min_late_agreement tracker.min_relocalised tracker.min_relocalised_share "
    "tracker.min_relocalized tracker.min_relocalized_share tracker.relocalise_radius "
    "tracker.time_jitter "
    "tracker.torn_share ";
#endif

}  // namespace

OldName FindOldName(const std::string& name) {
  for (const auto& renamed : kRenamed)
    if (renamed.before == name) return {std::string(renamed.now)};
#ifndef __EMSCRIPTEN__
  if (!name.empty() && name.find(' ') == std::string::npos &&
      kDropped.find(" " + name + " ") != std::string_view::npos)
    return {"", true};
#endif
  return {};
}

}  // namespace alidade
