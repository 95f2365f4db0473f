#include "alidade/dynamics/surface_belief.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/log_odds.h"
#include "alidade/dynamics/evidence.h"

namespace alidade {

SurfaceBelief::SurfaceBelief(const Cells& cells, const SurfaceBeliefSettings& settings,
                             const CellDepthSettings& depth_settings)
    : cells_(cells),
      settings_(settings),
      depth_settings_(depth_settings),
      log_odds_(cells.count(), kUnknownStatic),
      certainty_(cells.count(), 0) {}

std::vector<int> SurfaceBelief::Carry(std::span<const float> depth, const Se3& T_camera_world,
                                      const History& history) {
  std::vector<int> from(cells_.count(), -1);
  for (int ago = 1; ago <= settings_.gap; ++ago) {
    const PastView* last = history.Before(ago);
    if (!last || last->number != number_) continue;
    from = CompareDepth(cells_, depth, T_camera_world, *last, depth_settings_).met;
    break;
  }
  std::vector<float> log_odds(cells_.count(), kUnknownStatic), certainty(cells_.count(), 0);
  for (int i = 0; i < cells_.count(); ++i) {
    if (from[i] < 0) continue;
    log_odds[i] = log_odds_[from[i]] + settings_.forget * (kUnknownStatic - log_odds_[from[i]]);
    certainty[i] = settings_.remember * certainty_[from[i]];
  }
  log_odds_ = std::move(log_odds);
  certainty_ = std::move(certainty);
  return from;
}

// Evidence from depth. A surface at a position that an earlier view saw through has appeared since:
// log-odds `free`, weight 1. A surface that an earlier view shows at the same position, and that
// was not moving then, is static: log-odds `same`, weight
// w = max over views of min(1, age / young) × p,
// where age is the view's age in frames and p its probability of being static then (at least
// `rested` in views older than `settled`, except on detected objects). When w >= `trusted` the
// surface is not considered new, because depth is unreliable near outlines.
void SurfaceBelief::AddDepth(int number, std::span<const float> depth, const Se3& T_camera_world,
                             const History& history, Evidence& evidence) const {
  std::vector<float> same(cells_.count(), 0);
  std::vector<uint8_t> free(cells_.count(), 0);
  const auto compare = [&](const PastView* past) {
    if (!past || past->depth.empty()) return;
    const DepthComparison comparison =
        CompareDepth(cells_, depth, T_camera_world, *past, depth_settings_);
    const auto frames = static_cast<float>(number - past->number);
    const float age = std::min(1.0f, frames / settings_.young);
    const float least = frames >= settings_.settled ? settings_.rested : 0;
    for (int i = 0; i < cells_.count(); ++i) {
      free[i] |= comparison.result[i] == Comparison::kFree;
      if (comparison.result[i] != Comparison::kSame) continue;
      const float before = past->static_log_odds[comparison.met[i]];
      const float trust = std::max(before > kObjectStatic ? least : 0, ProbabilityOf(before));
      same[i] = std::max(same[i], age * trust);
    }
  };
  // The oldest possible view, the one in the middle, and the second newest; and two views of the
  // last second.
  const size_t older = history.most_older();
  for (size_t k : {older - 1, older / 2, size_t{1}}) compare(history.Older(k));
  for (int ago : {settings_.compare_far, settings_.compare_near}) compare(history.Before(ago));
  for (int i = 0; i < cells_.count(); ++i) {
    const bool moved = free[i] && same[i] < settings_.trusted;
    const float weight = moved ? 1 : same[i];
    evidence.weights[i] += weight;
    evidence.log_odds[i] += weight * (moved ? settings_.free : settings_.same);
  }
}

// Votes of tracks apply to the neighboring cells on the same surface. A "moved" vote is ignored
// where this frame's depth contradicts it.
void SurfaceBelief::AddFlow(std::span<const float> depth, std::span<const FlowTrack> tracks,
                            std::span<const int8_t> votes, Evidence& evidence) const {
  for (size_t t = 0; t < tracks.size(); ++t) {
    if (votes[t] == 0) continue;
    const bool moved = votes[t] < 0;
    const int cell = cells_.At(tracks[t].at().x, tracks[t].at().y);
    cells_.VisitAround(cell, 1, [&](int n) {
      if (ApartInDepth(depth, cell, n, depth_settings_) ||
          (moved && evidence.log_odds[n] > settings_.confirmed))
        return;
      evidence.log_odds[n] += moved ? settings_.flow_moved : settings_.flow_stood;
      evidence.weights[n] += moved ? 1 : settings_.flow_stood_weight;
    });
  }
}

// Moves the belief of a cell with little evidence toward that of its surface (formula:
// SurfaceBeliefSettings).
void SurfaceBelief::Spread(std::span<const float> depth, std::span<const uint8_t> suspect) {
  std::vector<float> values = log_odds_, weights(cells_.count());
  for (int i = 0; i < cells_.count(); ++i) weights[i] = certainty_[i] * certainty_[i];
  SpreadOverSurfaces(cells_, depth, settings_.spread_fade, values, weights, depth_settings_);
  for (int i = 0; i < cells_.count(); ++i) {
    const float share = settings_.spread_rate * (1 - certainty_[i]) *
                        std::min(1.0f, settings_.spread_heard * weights[i]);
    const float heard = suspect[i]
                            ? values[i]
                            : std::max(values[i], std::min(settings_.spread_least, log_odds_[i]));
    log_odds_[i] += share * (heard - log_odds_[i]);
  }
}

void SurfaceBelief::Update(int number, std::span<const float> depth, const Se3& T_camera_world,
                           const History& history, std::span<const uint8_t> resting,
                           std::span<const uint8_t> suspect, std::span<const FlowTrack> tracks,
                           std::span<const int8_t> votes) {
  number_ = number;
  Evidence evidence{std::vector<float>(cells_.count(), 0), std::vector<float>(cells_.count(), 0)};
  AddDepth(number, depth, T_camera_world, history, evidence);
  AddFlow(depth, tracks, votes, evidence);
  for (int i = 0; i < cells_.count(); ++i) {
    if (resting[i] && evidence.log_odds[i] > 0) continue;
    log_odds_[i] = std::clamp(log_odds_[i] + evidence.log_odds[i], -kCertainStatic, kCertainStatic);
    certainty_[i] = std::min(1.0f, certainty_[i] + settings_.learn * evidence.weights[i]);
  }
  Spread(depth, suspect);
}

}  // namespace alidade
