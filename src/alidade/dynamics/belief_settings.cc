#include "alidade/dynamics/belief_settings.h"

#include <sstream>

#include "alidade/base/error.h"
#include "alidade/dynamics/flow_tracks.h"

namespace alidade {
namespace {

// Checks the ranges of the fields of one part; NaN is refused.
class FieldCheck {
 public:
  explicit FieldCheck(const char* part) : part_(part) {}
  void Range(const char* field, double value, double low, double high) const {
    if (value >= low && value <= high) return;
    std::ostringstream text;
    text << "dynamics." << part_ << "." << field << " must be from " << low << " to " << high;
    ThrowUsage(text.str());
  }
  void Share(const char* field, double value) const { Range(field, value, 0, 1); }
  // Evidence for motion must be negative, evidence against it positive.
  void Moved(const char* field, double value) const { Range(field, value, -10, 0); }
  void Stood(const char* field, double value) const { Range(field, value, 0, 10); }

 private:
  const char* part_;
};

constexpr int kTrackFrames = FlowTracks::kHistory - 1;  // length of tracks in frames

}  // namespace

void CellDepthSettings::Check() const {
  const FieldCheck check("depth");
  check.Range("min_readings", min_readings, 1, 9);
  check.Range("spread_step", spread_step, 0.001, 1);
  check.Share("spread_unmeasured", spread_unmeasured);
  check.Range("tolerance_linear", tolerance_linear, 0, 10);
  check.Range("tolerance_square", tolerance_square, 0, 10);
  check.Range("free_tolerances", free_tolerances, 1, 100);
  check.Range("free_neighbours", free_neighbours, 1, 9);
  check.Range("stereo_nearest", stereo_nearest, 0.01, 100);
  check.Range("stereo_window", stereo_window, 5, 51);
  if (stereo_window % 2 == 0) ThrowUsage("dynamics.depth.stereo_window must be odd");
  check.Range("stereo_texture", stereo_texture, 0, 10000);
  check.Range("stereo_uniqueness", stereo_uniqueness, 0, 100);
}

void HistorySettings::Check() const {
  const FieldCheck check("history");
  check.Range("recent", recent, 1, 300);
  check.Range("step", step, 1, 300);
  check.Range("older", older, 1, 300);
}

void FlowVoteSettings::Check() const {
  const FieldCheck check("votes");
  check.Range("most_ago", most_ago, 1, kTrackFrames);
  check.Range("least_ago", least_ago, 1, most_ago);
  check.Range("measured_px", measured_px, 0, 100);
  check.Range("measured_share", measured_share, 0, 10);
  check.Range("depth_noise", depth_noise, 0, 0.9);
  check.Range("consensus_reach", consensus_reach, 0, 20);
  check.Range("consensus_tracks", consensus_tracks, 1, 1000);
  check.Range("agreement_ago", agreement_ago, 1, kTrackFrames);
  check.Range("agreement_iterations", agreement_iterations, 1, 10000);
  check.Range("agreement_tracks", agreement_tracks, 8, 1000);
  check.Share("agreement_share", agreement_share);
  check.Range("homography_share", homography_share, 0, 2);
  check.Range("rival_block", rival_block, 1, 80);
  check.Range("rival_blocks", rival_blocks, 1, 10000);
}

void SurfaceBeliefSettings::Check() const {
  const FieldCheck check("surfaces");
  check.Share("remember", remember);
  check.Share("learn", learn);
  check.Range("gap", gap, 1, 300);
  check.Moved("free", free);
  check.Stood("same", same);
  check.Range("compare_near", compare_near, 1, 300);
  check.Range("compare_far", compare_far, 1, 300);
  check.Range("young", young, 1, 10000);
  check.Range("settled", settled, 1, 10000);
  check.Share("rested", rested);
  check.Share("trusted", trusted);
  check.Stood("confirmed", confirmed);
  check.Moved("flow_moved", flow_moved);
  check.Stood("flow_stood", flow_stood);
  check.Share("flow_stood_weight", flow_stood_weight);
  check.Share("spread_fade", spread_fade);
  check.Share("spread_rate", spread_rate);
  check.Range("spread_heard", spread_heard, 0, 1000);
  check.Moved("spread_least", spread_least);
}

void TrackBeliefSettings::Check() const {
  const FieldCheck check("tracks");
  check.Moved("moved", moved);
  check.Stood("stood", stood);
  check.Range("least", least, -100, 0);
  check.Range("most", most, 0, 100);
  check.Share("forget", forget);
  check.Range("proven", proven, 0, 100);
  check.Share("fade", fade);
}

void ObjectSettings::Check() const {
  const FieldCheck check("objects");
  check.Share("same_overlap", same_overlap);
  check.Range("flow_tracks", flow_tracks, 1, 1000);
  check.Share("flow_middle", flow_middle);
  check.Range("rest_tracks", rest_tracks, 1, 1000);
  check.Share("moves_share", moves_share);
  check.Share("rests_share", rests_share);
  check.Moved("moved", moved);
  check.Stood("rested", rested);
  check.Share("carried_share", carried_share);
}

void BoxSettings::Check() const {
  const FieldCheck check("box");
  check.Share("widen", widen);
  check.Range("reach", reach, 0, 10);
  check.Range("min_reach", min_reach, 0, 100);
  check.Range("seed", seed, 0, 10);
  check.Range("seed_middle", seed_middle, 0, 2);
  check.Range("step", step, 0, 10);
  check.Range("known_static", known_static, -10, 10);
  check.Range("middle", middle, 0, 2);
  check.Share("most_still", most_still);
  check.Range("island_before", island_before, 0, 10);
  check.Range("island_behind", island_behind, 0, 10);
  check.Range("oval", oval, 1, 100);
  check.Share("rim", rim);
}

void FeatureBeliefSettings::Check() const {
  const FieldCheck check("features");
  check.Share("sure", sure);
  check.Share("surface", surface);
  check.Range("far_cells", far_cells, 0, 80);
  check.Range("reading_reach", reading_reach, 0, 20);
  check.Range("enough_count", enough_count, 0, 100000);
}

void LandmarkEvidenceSettings::Check() const {
  const FieldCheck check("landmarks");
  check.Range("min_neighbours", min_neighbours, 1, 9);
  check.Moved("on_mover", on_mover);
  check.Moved("gone", gone);
  check.Moved("hidden_found", hidden_found);
  check.Stood("found", found);
  check.Share("most_on_movers", most_on_movers);
}

}  // namespace alidade
