// Probability of each track to be static, where no depth is measured, and from it that of the
// cells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alidade/dynamics/belief_settings.h"
#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/flow_tracks.h"

namespace alidade {

class TrackBelief {
 public:
  explicit TrackBelief(const TrackBeliefSettings& settings = {}) : settings_(settings) {}

  // Adds the votes of Consensus() to the belief of each track.
  void Update(std::span<const FlowTrack> tracks, std::span<const int8_t> votes);
  // Log-odds of each cell, from the tracks in and around it.
  std::vector<float> OfCells(const Cells& cells, std::span<const FlowTrack> tracks) const;
  // Cells (nonzero) with a track that was repeatedly static.
  std::vector<uint8_t> Proven(const Cells& cells, std::span<const FlowTrack> tracks) const;

 private:
  struct Entry {
    uint32_t id = 0;
    float log_odds = 0;  // relative to the log-odds of an unknown track
  };
  TrackBeliefSettings settings_;
  std::vector<Entry> entries_;  // one per track, sorted by id
};

}  // namespace alidade
