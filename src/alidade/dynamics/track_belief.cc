#include "alidade/dynamics/track_belief.h"

#include <algorithm>

#include "alidade/dynamics/evidence.h"
#include "alidade/dynamics/surface_belief.h"

namespace alidade {
namespace {

constexpr float kMoved = -1.0f, kStood = 0.1f;  // log-odds, per frame
constexpr float kLeast = -6, kMost = 3;
constexpr float kForget = 0.01f;
constexpr float kProven = 1.5f;
constexpr float kFade = 0.35f;  // from cell to cell

}  // namespace

void TrackBelief::Update(std::span<const FlowTrack> tracks, std::span<const int8_t> votes) {
  // Tracks come and go but keep their order.
  std::vector<Entry> entries;
  size_t old = 0;
  for (size_t i = 0; i < tracks.size(); ++i) {
    while (old < entries_.size() && entries_[old].id < tracks[i].id) ++old;
    const bool known = old < entries_.size() && entries_[old].id == tracks[i].id;
    float log_odds = known ? (1 - kForget) * entries_[old].log_odds : 0;
    if (votes[i] != 0) log_odds += votes[i] < 0 ? kMoved : kStood;
    entries.push_back({tracks[i].id, std::clamp(log_odds, kLeast, kMost)});
  }
  entries_ = std::move(entries);
}

std::vector<float> TrackBelief::OfCells(const Cells& cells,
                                        std::span<const FlowTrack> tracks) const {
  std::vector<float> values(cells.count(), 0), weights(cells.count(), 0);
  for (size_t i = 0; i < tracks.size(); ++i) {
    const int cell = cells.At(tracks[i].at().x, tracks[i].at().y);
    values[cell] += entries_[i].log_odds;
    weights[cell] += 1;
  }
  for (int i = 0; i < cells.count(); ++i) {
    if (weights[i] > 0) values[i] /= weights[i];
  }
  SpreadOverSurfaces(cells, {}, kFade, values, weights);
  for (float& value : values) value += kUnknownStatic;
  return values;
}

std::vector<uint8_t> TrackBelief::Proven(const Cells& cells,
                                         std::span<const FlowTrack> tracks) const {
  std::vector<uint8_t> proven(cells.count(), 0);
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (entries_[i].log_odds < kProven) continue;
    proven[cells.At(tracks[i].at().x, tracks[i].at().y)] = 1;
  }
  return proven;
}

}  // namespace alidade
