#include "alidade/dynamics/track_belief.h"

#include <algorithm>

#include "alidade/dynamics/evidence.h"
#include "alidade/dynamics/surface_belief.h"

namespace alidade {

void TrackBelief::Update(std::span<const FlowTrack> tracks, std::span<const int8_t> votes) {
  // l = (1 - forget) l + moved or stood, clamped to [least, most]. Tracks appear and disappear but
  // stay in order of id.
  std::vector<Entry> entries;
  size_t old = 0;
  for (size_t i = 0; i < tracks.size(); ++i) {
    while (old < entries_.size() && entries_[old].id < tracks[i].id) ++old;
    const bool known = old < entries_.size() && entries_[old].id == tracks[i].id;
    float log_odds = known ? (1 - settings_.forget) * entries_[old].log_odds : 0;
    if (votes[i] != 0) log_odds += votes[i] < 0 ? settings_.moved : settings_.stood;
    entries.push_back({tracks[i].id, std::clamp(log_odds, settings_.least, settings_.most)});
  }
  entries_ = std::move(entries);
}

std::vector<float> TrackBelief::OfCells(const Cells& cells,
                                        std::span<const FlowTrack> tracks) const {
  // The mean of the tracks in a cell, spread to its neighbors; the unknown's log-odds where no
  // track is near.
  std::vector<float> values(cells.count(), 0), weights(cells.count(), 0);
  for (size_t i = 0; i < tracks.size(); ++i) {
    const int cell = cells.At(tracks[i].at().x, tracks[i].at().y);
    values[cell] += entries_[i].log_odds;
    weights[cell] += 1;
  }
  for (int i = 0; i < cells.count(); ++i) {
    if (weights[i] > 0) values[i] /= weights[i];
  }
  SpreadOverSurfaces(cells, {}, settings_.fade, values, weights);
  for (float& value : values) value += kUnknownStatic;
  return values;
}

std::vector<uint8_t> TrackBelief::Proven(const Cells& cells,
                                         std::span<const FlowTrack> tracks) const {
  std::vector<uint8_t> proven(cells.count(), 0);
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (entries_[i].log_odds < settings_.proven) continue;
    proven[cells.At(tracks[i].at().x, tracks[i].at().y)] = 1;
  }
  return proven;
}

}  // namespace alidade
