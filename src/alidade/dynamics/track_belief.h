// How likely each track stands still, where no depth is measured, and what the picture looks like
// around it.
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

  // Adds the votes of Consensus() to what is believed of each track.
  void Update(std::span<const FlowTrack> tracks, std::span<const int8_t> votes);
  // Log-odds of each cell: what is believed of the tracks in and around it.
  std::vector<float> OfCells(const Cells& cells, std::span<const FlowTrack> tracks) const;
  // Of each cell, nonzero: it has a track that was seen to stand still again and again.
  std::vector<uint8_t> Proven(const Cells& cells, std::span<const FlowTrack> tracks) const;

 private:
  struct Entry {
    uint32_t id = 0;
    float log_odds = 0;  // added to that of the unknown
  };
  TrackBeliefSettings settings_;
  std::vector<Entry> entries_;  // one for each track, in order of id
};

}  // namespace alidade
