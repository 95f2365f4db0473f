// Every field that has a name after --set, once: read, written and named from here. Private to
// settings.cc.
#pragma once

#include "alidade/system/dynamics_fields.h"
#include "alidade/system/settings.h"

namespace alidade {

// `visit(name, field)` for every field; `Settings` is SlamSettings, const or not.
template <typename Settings, typename Visit>
void VisitTracking(Settings& t, Visit&& visit) {
  visit("tracker.extractor.features", t.extractor.features);
  visit("tracker.extractor.fast_threshold", t.extractor.fast_threshold);
  visit("tracker.extractor.fast_minimum", t.extractor.fast_minimum);
  visit("tracker.extractor.cell", t.extractor.cell);
  visit("tracker.match_scale", t.match_scale);
  visit("tracker.min_predicted", t.min_predicted);
  visit("tracker.min_after_prediction", t.min_after_prediction);
  visit("tracker.min_tracked", t.min_tracked);
  visit("tracker.min_found_share", t.min_found_share);
  visit("tracker.torn_share", t.torn_share);
  visit("tracker.unproven_frames", t.unproven_frames);
  visit("tracker.unproven_seconds", t.unproven_seconds);
  visit("tracker.min_late_agreement", t.min_late_agreement);
  visit("tracker.predict_seconds", t.predict_seconds);
  visit("tracker.min_agreement", t.min_agreement);
  visit("tracker.good_agreement", t.good_agreement);
  visit("tracker.bad_frame_sigma", t.bad_frame_sigma);
  visit("tracker.max_distance", t.max_distance);
  visit("tracker.local_ratio", t.local_ratio);
  visit("tracker.last_frame_radius", t.last_frame_radius);
  visit("tracker.last_frame_radius_depth", t.last_frame_radius_depth);
  visit("tracker.local_radius", t.local_radius);
  visit("tracker.local_radius_depth", t.local_radius_depth);
  visit("tracker.local_keyframes", t.local_keyframes);
  visit("tracker.relocalise_radius", t.relocalise_radius);
  visit("tracker.min_relocalised", t.min_relocalised);
  visit("tracker.min_relocalised_share", t.min_relocalised_share);
  visit("tracker.min_relocalised_spread", t.min_relocalised_spread);
  visit("tracker.sigma_px", t.noise.sigma_px);
  visit("tracker.sigma_right_px", t.noise.sigma_right_px);
  visit("tracker.depth_range", t.depth_range);
  visit("tracker.keyframe_share_mono", t.keyframe_share_mono);
  visit("tracker.keyframe_share_depth", t.keyframe_share_depth);
  visit("tracker.keyframe_min_gap", t.keyframe_min_gap);
  visit("tracker.keyframe_max_gap", t.keyframe_max_gap);
  visit("tracker.max_extrapolation", t.motion.max_extrapolation);
  visit("tracker.time_jitter", t.motion.jitter);
}

template <typename Settings, typename Visit>
void VisitMapping(Settings& m, Visit&& visit) {
  visit("mapper.sigma_px", m.noise.sigma_px);
  visit("mapper.sigma_right_px", m.noise.sigma_right_px);
  visit("mapper.match_scale", m.match_scale);
  visit("mapper.sensor_noise", m.noise.sensor_noise);
  visit("mapper.max_depth_error", m.max_depth_error);
  visit("mapper.triangulate_keyframes_mono", m.triangulate_keyframes_mono);
  visit("mapper.triangulate_keyframes_depth", m.triangulate_keyframes_depth);
  visit("mapper.triangulate_distance", m.triangulate_distance);
  visit("mapper.triangulate_ratio", m.triangulate_ratio);
  visit("mapper.min_parallax_degrees", m.min_parallax_degrees);
  visit("mapper.min_parallax_degrees_mono", m.min_parallax_degrees_mono);
  visit("mapper.min_baseline_ratio", m.min_baseline_ratio);
  visit("mapper.max_baseline_error", m.max_baseline_error);
  visit("mapper.enough_known_scale", m.enough_known_scale);
  visit("mapper.min_known_scale", m.min_known_scale);
  visit("mapper.max_unknown_scale_seconds", m.max_unknown_scale_seconds);
  visit("mapper.max_unknown_scale_motion", m.max_unknown_scale_motion);
  visit("mapper.turn_landmarks", m.turn_landmarks);
  visit("mapper.turn_radius", m.turn_radius);
  visit("mapper.assumed_depth_error", m.assumed_depth_error);
  visit("mapper.assumed_depth_degrees", m.assumed_depth_degrees);
  visit("mapper.fuse_keyframes", m.fuse_keyframes);
  visit("mapper.fuse_radius", m.fuse_radius);
  visit("mapper.fuse_distance", m.fuse_distance);
  visit("mapper.min_found_share", m.min_found_share);
  visit("mapper.trial_keyframes", m.trial_keyframes);
  visit("mapper.redundant_share", m.redundant_share);
  visit("mapper.max_keyframes", m.max_keyframes);
  visit("mapper.window_keyframes", m.window_keyframes);
  visit("mapper.window_fixed", m.window_fixed);
  visit("mapper.window_shared", m.window_shared);
  visit("mapper.window_iterations_mono", m.window_iterations_mono);
  visit("mapper.least_noise", m.least_noise);
  visit("mapper.bundle.max_iterations", m.bundle.max_iterations);
  visit("mapper.bundle.min_relative_decrease", m.bundle.min_relative_decrease);
}

template <typename Settings, typename Visit>
void VisitLooping(Settings& l, Visit&& visit) {
  visit("loop.enabled", l.enabled);
  visit("loop.sigma_px", l.noise.sigma_px);
  visit("loop.sigma_right_px", l.noise.sigma_right_px);
  visit("loop.match_scale", l.match_scale);
  visit("loop.candidates", l.candidates);
  visit("loop.group", l.group);
  visit("loop.score_share", l.score_share);
  visit("loop.tied_share", l.tied_share);
  visit("loop.max_view_turn", l.max_view_turn);
  visit("loop.min_matches", l.min_matches);
  visit("loop.min_aligned", l.min_aligned);
  visit("loop.min_found", l.min_found);
  visit("loop.min_merge_found", l.min_merge_found);
  visit("loop.min_merge_alike", l.min_merge_alike);
  visit("loop.min_known_scale", l.min_known_scale);
  visit("loop.alike_radius", l.alike_radius);
  visit("loop.min_found_share", l.min_found_share);
  visit("loop.search_radius", l.search_radius);
  visit("loop.max_distance", l.max_distance);
  visit("loop.confirm_keyframes", l.confirm_keyframes);
  visit("loop.confirm_needed", l.confirm_needed);
  visit("loop.confirm_found", l.confirm_found);
  visit("loop.max_drift", l.max_drift);
  visit("loop.max_drift_floor", l.max_drift_floor);
  visit("loop.max_turn", l.max_turn);
  visit("loop.max_scale", l.max_scale);
  visit("loop.max_plain_scale", l.max_plain_scale);
  visit("loop.reach.speed", l.reach.speed);
  visit("loop.reach.span", l.reach.span);
  visit("loop.reach.depth_speed", l.reach.depth_speed);
  visit("loop.reach.floor", l.reach.floor);
  visit("loop.reach.drift", l.reach.drift);
  visit("loop.reach.plain_share", l.reach.plain_share);
  visit("loop.reach.plain_alike", l.reach.plain_alike);
  visit("loop.reach.elsewhere_share", l.reach.elsewhere_share);
  visit("loop.graph_shared", l.graph_shared);
  visit("loop.graph.max_iterations", l.graph.max_iterations);
  visit("loop.graph.length_scale", l.graph.length_scale);
  visit("loop.bundle.max_iterations", l.bundle.max_iterations);
  visit("loop.bundle.min_relative_decrease", l.bundle.min_relative_decrease);
}

template <typename Settings, typename Visit>
void VisitPlaces(Settings& p, Visit&& visit) {
  visit("places.sample", p.sample);
  visit("places.branching", p.vocabulary.branching);
  visit("places.levels", p.vocabulary.levels);
  visit("places.min_split", p.vocabulary.min_split);
  visit("places.rounds", p.vocabulary.rounds);
  visit("places.shortlist", p.shortlist);
  visit("places.match_level", p.matching.level);
  visit("places.match_max_distance", p.matching.max_distance);
  visit("places.match_ratio", p.matching.ratio);
}

template <typename Settings, typename Visit>
void VisitSemiDense(Settings& d, Visit&& visit) {
  visit("semidense.enabled", d.enabled);
  visit("semidense.from_sensor", d.from_sensor);
  visit("semidense.keyframes", d.keyframes);
  visit("semidense.min_gradient", d.min_gradient);
  visit("semidense.max_edge_angle", d.max_edge_angle);
  visit("semidense.max_turn", d.max_turn);
  visit("semidense.gradient_weight", d.gradient_weight);
  visit("semidense.intensity_sigma", d.intensity_sigma);
  visit("semidense.line_sigma", d.line_sigma);
  visit("semidense.max_residual", d.max_residual);
  visit("semidense.chi2_pair", d.chi2_pair);
  visit("semidense.chi2_check", d.chi2_check);
  visit("semidense.min_compatible", d.min_compatible);
  visit("semidense.max_landmark_difference", d.max_landmark_difference);
  visit("semidense.fuse", d.fuse);
  visit("semidense.smooth", d.smooth);
  visit("semidense.cross_check", d.cross_check);
  visit("semidense.delay", d.delay);
  visit("semidense.redo_baseline", d.redo_baseline);
  visit("semidense.max_waiting", d.max_waiting);
  visit("semidense.voxel", d.voxel);
}

template <typename Settings, typename Visit>
void VisitStart(Settings& i, Visit&& visit) {
  visit("start.min_depth_landmarks", i.min_depth_landmarks);
  visit("start.min_matches", i.min_matches);
  visit("start.match_scale", i.match_scale);
  visit("start.references", i.references);
  visit("start.reference_gap", i.reference_gap);
  visit("start.window", i.window);
  visit("start.min_motion", i.min_motion);
  visit("start.still_pixels", i.still_pixels);
  visit("start.max_still_share", i.max_still_share);
  visit("start.min_still_peak", i.min_still_peak);
  visit("start.min_still_area", i.min_still_area);
  visit("start.max_still_picture", i.max_still_picture);
  visit("start.trial_frames", i.trial_frames);
  visit("start.trial_share", i.trial_share);
  visit("start.iterations", i.two_view.iterations);
  visit("start.sigma", i.two_view.sigma);
  visit("start.homography_share", i.two_view.homography_share);
  visit("start.min_parallax_degrees", i.two_view.min_parallax_degrees);
  visit("start.min_triangulated", i.two_view.min_triangulated);
  visit("start.max_direction_sigma_degrees", i.two_view.max_direction_sigma_degrees);
  visit("start.min_placed_share", i.two_view.min_placed_share);
  visit("start.turn_sigma", i.two_view.turn_sigma);
  visit("start.min_beyond_turn", i.two_view.min_beyond_turn);
  visit("start.min_beyond_lens", i.two_view.min_beyond_lens);
  visit("start.lens_uncertainty", i.two_view.lens_uncertainty);
  visit("start.still_memory", i.still_memory);
  visit("start.min_still_motion", i.min_still_motion);
  visit("start.min_still_frames", i.min_still_frames);
}

template <typename Settings, typename Visit>
void VisitEarly(Settings& e, Visit&& visit) {
  visit("early.most", e.most);
  visit("early.settle", e.settle);
  visit("early.most_missed", e.most_missed);
  visit("early.max_leap", e.max_leap);
  visit("early.min_leap", e.min_leap);
  visit("early.leap_seconds", e.leap_seconds);
}

template <typename Settings, typename Visit>
void VisitReadout(Settings& r, Visit&& visit) {
  visit("readout.enabled", r.enabled);
  visit("readout.first_keyframes", r.first_keyframes);
  visit("readout.growth", r.growth);
  visit("readout.max_windows", r.max_windows);
  visit("readout.prior_sigma", r.prior_sigma);
  visit("readout.min_hint", r.min_hint);
  visit("readout.hint_sigma", r.hint_sigma);
  visit("readout.hint_explained", r.hint_explained);
  visit("readout.hint_frames", r.hint_frames);
  visit("readout.hint_growth", r.hint_growth);
  visit("readout.hints_upright", r.hints_upright);
  visit("readout.max_iterations", r.max_iterations);
  visit("readout.max_sigma", r.max_sigma);
  visit("readout.least", r.least);
  visit("readout.longest", r.longest);
  visit("readout.min_change", r.min_change);
}

template <typename Settings, typename Visit>
void VisitRefine(Settings& r, Visit&& visit) {
  visit("refine.enabled", r.enabled);
  visit("refine.first_keyframes", r.first_keyframes);
  visit("refine.growth", r.growth);
  visit("refine.max_windows", r.max_windows);
  visit("refine.focal_sigma", r.focal_sigma);
  visit("refine.readout_sigma", r.readout_sigma);
  visit("refine.max_sigma", r.max_sigma);
  visit("refine.far_off", r.far_off);
  visit("refine.again", r.again);
  visit("refine.settled", r.settled);
  visit("refine.settled_cost", r.settled_cost);
  visit("refine.min_change", r.min_change);
  visit("refine.step", r.step);
  visit("refine.rework", r.rework);
  visit("refine.begin_anew", r.begin_anew);
  visit("refine.keep_frames", r.keep_frames);
  visit("refine.bend_windows", r.bend_windows);
}

template <typename Settings, typename Visit>
void VisitFields(Settings& s, Visit&& visit) {
  visit("image_width", s.image_width);
  visit("max_image_side", s.max_image_side);
  visit("seed", s.seed);
  visit("new_map_seconds", s.new_map_seconds);
  visit("new_map_frames", s.new_map_frames);
  visit("min_map_keyframes", s.min_map_keyframes);
  visit("trajectory.keep_seconds", s.trajectory.keep_seconds);
  visit("time.gap_seconds", s.time.gap_seconds);
  visit("time.gap_intervals", s.time.gap_intervals);
  visit("time.agree_frames", s.time.agree_frames);
  visit("time.max_latency", s.time.max_latency);
  VisitTracking(s.tracker, visit);
  VisitMapping(s.mapper, visit);
  VisitLooping(s.loop, visit);
  VisitPlaces(s.places, visit);
  VisitSemiDense(s.semidense, visit);
  VisitDynamics(s.dynamics, visit);
  VisitStart(s.start, visit);
  VisitEarly(s.early, visit);
  VisitReadout(s.readout, visit);
  VisitRefine(s.refine, visit);
}

}  // namespace alidade
