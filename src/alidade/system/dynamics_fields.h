// Those fields of settings_fields.h that begin with "dynamics.".
#pragma once

#include "alidade/dynamics/settings.h"

namespace alidade {

// Thresholds of dynamics, by part.
template <typename Settings, typename Visit>
void VisitBelief(Settings& y, Visit&& visit) {
  auto& c = y.depth;
  visit("dynamics.depth.min_readings", c.min_readings);
  visit("dynamics.depth.surface_step", c.surface_step);
  visit("dynamics.depth.spread_step", c.spread_step);
  visit("dynamics.depth.spread_unmeasured", c.spread_unmeasured);
  visit("dynamics.depth.tolerance", c.tolerance);
  visit("dynamics.depth.tolerance_linear", c.tolerance_linear);
  visit("dynamics.depth.tolerance_square", c.tolerance_square);
  visit("dynamics.depth.free_tolerances", c.free_tolerances);
  visit("dynamics.depth.free_neighbours", c.free_neighbours);
  visit("dynamics.depth.stereo_nearest", c.stereo_nearest);
  visit("dynamics.depth.stereo_window", c.stereo_window);
  visit("dynamics.depth.stereo_texture", c.stereo_texture);
  visit("dynamics.depth.stereo_uniqueness", c.stereo_uniqueness);
  auto& h = y.history;
  visit("dynamics.history.recent", h.recent);
  visit("dynamics.history.step", h.step);
  visit("dynamics.history.older", h.older);
  auto& v = y.votes;
  visit("dynamics.votes.least_ago", v.least_ago);
  visit("dynamics.votes.most_ago", v.most_ago);
  visit("dynamics.votes.moved_px", v.moved_px);
  visit("dynamics.votes.moved_share", v.moved_share);
  visit("dynamics.votes.measured_px", v.measured_px);
  visit("dynamics.votes.measured_share", v.measured_share);
  visit("dynamics.votes.depth_noise", v.depth_noise);
  visit("dynamics.votes.consensus_reach", v.consensus_reach);
  visit("dynamics.votes.consensus_tracks", v.consensus_tracks);
  visit("dynamics.votes.consensus", v.consensus);
  visit("dynamics.votes.agreement_ago", v.agreement_ago);
  visit("dynamics.votes.agreement_iterations", v.agreement_iterations);
  visit("dynamics.votes.agreement_tracks", v.agreement_tracks);
  visit("dynamics.votes.agreement_share", v.agreement_share);
  visit("dynamics.votes.agreement_sigma", v.agreement_sigma);
  visit("dynamics.votes.homography_share", v.homography_share);
  visit("dynamics.votes.rival_block", v.rival_block);
  visit("dynamics.votes.rival_blocks", v.rival_blocks);
  visit("dynamics.votes.rival_share", v.rival_share);
  visit("dynamics.votes.rival_frames", v.rival_frames);
  auto& u = y.surfaces;
  visit("dynamics.surfaces.forget", u.forget);
  visit("dynamics.surfaces.remember", u.remember);
  visit("dynamics.surfaces.learn", u.learn);
  visit("dynamics.surfaces.gap", u.gap);
  visit("dynamics.surfaces.free", u.free);
  visit("dynamics.surfaces.same", u.same);
  visit("dynamics.surfaces.compare_near", u.compare_near);
  visit("dynamics.surfaces.compare_far", u.compare_far);
  visit("dynamics.surfaces.young", u.young);
  visit("dynamics.surfaces.settled", u.settled);
  visit("dynamics.surfaces.rested", u.rested);
  visit("dynamics.surfaces.trusted", u.trusted);
  visit("dynamics.surfaces.confirmed", u.confirmed);
  visit("dynamics.surfaces.flow_moved", u.flow_moved);
  visit("dynamics.surfaces.flow_stood", u.flow_stood);
  visit("dynamics.surfaces.flow_stood_weight", u.flow_stood_weight);
  visit("dynamics.surfaces.spread_fade", u.spread_fade);
  visit("dynamics.surfaces.spread_rate", u.spread_rate);
  visit("dynamics.surfaces.spread_heard", u.spread_heard);
  visit("dynamics.surfaces.spread_least", u.spread_least);
  auto& t = y.tracks;
  visit("dynamics.tracks.moved", t.moved);
  visit("dynamics.tracks.stood", t.stood);
  visit("dynamics.tracks.least", t.least);
  visit("dynamics.tracks.most", t.most);
  visit("dynamics.tracks.forget", t.forget);
  visit("dynamics.tracks.proven", t.proven);
  visit("dynamics.tracks.fade", t.fade);
  auto& o = y.objects;
  visit("dynamics.objects.same_overlap", o.same_overlap);
  visit("dynamics.objects.flow_tracks", o.flow_tracks);
  visit("dynamics.objects.flow_middle", o.flow_middle);
  visit("dynamics.objects.rest_tracks", o.rest_tracks);
  visit("dynamics.objects.moves_share", o.moves_share);
  visit("dynamics.objects.rests_share", o.rests_share);
  visit("dynamics.objects.moved", o.moved);
  visit("dynamics.objects.rested", o.rested);
  visit("dynamics.objects.carried_share", o.carried_share);
  auto& b = y.box;
  visit("dynamics.box.widen", b.widen);
  visit("dynamics.box.reach", b.reach);
  visit("dynamics.box.min_reach", b.min_reach);
  visit("dynamics.box.seed", b.seed);
  visit("dynamics.box.seed_middle", b.seed_middle);
  visit("dynamics.box.step", b.step);
  visit("dynamics.box.known_static", b.known_static);
  visit("dynamics.box.middle", b.middle);
  visit("dynamics.box.most_still", b.most_still);
  visit("dynamics.box.island_before", b.island_before);
  visit("dynamics.box.island_behind", b.island_behind);
  visit("dynamics.box.oval", b.oval);
  visit("dynamics.box.rim", b.rim);
  auto& f = y.features;
  visit("dynamics.features.sure", f.sure);
  visit("dynamics.features.surface", f.surface);
  visit("dynamics.features.far_cells", f.far_cells);
  visit("dynamics.features.reading_reach", f.reading_reach);
  visit("dynamics.features.enough_share", f.enough_share);
  visit("dynamics.features.enough_count", f.enough_count);
  visit("dynamics.features.uncertain_weight", f.uncertain_weight);
  auto& l = y.landmarks;
  visit("dynamics.landmarks.min_neighbours", l.min_neighbours);
  visit("dynamics.landmarks.on_mover", l.on_mover);
  visit("dynamics.landmarks.gone", l.gone);
  visit("dynamics.landmarks.hidden_found", l.hidden_found);
  visit("dynamics.landmarks.found", l.found);
  visit("dynamics.landmarks.most_on_movers", l.most_on_movers);
}

template <typename Settings, typename Visit>
void VisitDynamics(Settings& y, Visit&& visit) {
  visit("dynamics.mode", y.mode);
  visit("dynamics.watch_frames", y.watch_frames);
  visit("dynamics.watch_every", y.watch_every);
  visit("dynamics.watch_mean", y.watch_mean);
  visit("dynamics.watch_moved", y.watch_moved);
  visit("dynamics.watch_moved_depth", y.watch_moved_depth);
  visit("dynamics.watch_rival_frames", y.watch_rival_frames);
  visit("dynamics.watch_lens", y.watch_lens);
  visit("dynamics.moving_classes", y.moving_classes);
  visit("dynamics.carried_classes", y.carried_classes);
  visit("dynamics.detector.min_score", y.detector.min_score);
  visit("dynamics.detector.max_overlap", y.detector.max_overlap);
  visit("dynamics.detector_every_frames", y.detector_every_frames);
  visit("dynamics.detector_latency_frames", y.detector_latency_frames);
  visit("dynamics.detector_rest", y.detector_rest);
  visit("dynamics.drop_detections", y.drop_detections);
  visit("dynamics.bridge_seconds", y.bridge_seconds);
  visit("dynamics.foreground", y.foreground);
  visit("dynamics.geometry", y.geometry);
  visit("dynamics.propagate", y.propagate);
  visit("dynamics.weigh", y.weigh);
  VisitBelief(y, visit);
}

}  // namespace alidade
