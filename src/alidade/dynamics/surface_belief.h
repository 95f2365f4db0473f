// How likely each cell of the picture shows what stands still, where depth is measured.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/flow_tracks.h"
#include "alidade/dynamics/history.h"

namespace alidade {

// The scale of belief: log-odds l = ln(p / (1 - p)) of standing still.
inline constexpr float kUnknownStatic = 1.5f;    // of what nothing is known of: p = 0.82
inline constexpr float kCertainStatic = 5;       // bound of all log-odds: p = 0.993
inline constexpr float kObjectStatic = -4;       // of what a detector knows to move: p = 0.018 …
inline constexpr float kRestingStatic = -0.85f;  // … at most, while it is seen to rest: p = 0.3

class SurfaceBelief {
 public:
  // Keeps a reference to `cells`.
  explicit SurfaceBelief(const Cells& cells, const SurfaceBeliefSettings& settings = {},
                         const CellDepthSettings& depth_settings = {});

  // Moves all that is believed on to the present frame: what a cell shows is believed to be what
  // was at its place in the last one; movers are large against their motion in a frame. Returns for
  // each cell the one of the last frame it takes after, -1: none.
  std::vector<int> Carry(std::span<const float> depth, const Se3& T_camera_world,
                         const History& history);
  // Adds what this frame says. `resting`: cells (nonzero) of what moves by itself, which may rest
  // but is not believed to be static for it. `suspect`: cells (nonzero) where a detector sees a
  // mover: what is only heard of them is believed. `votes`: Consensus() of the tracks.
  void Update(int number, std::span<const float> depth, const Se3& T_camera_world,
              const History& history, std::span<const uint8_t> resting,
              std::span<const uint8_t> suspect, std::span<const FlowTrack> tracks,
              std::span<const int8_t> votes);
  const std::vector<float>& log_odds() const { return log_odds_; }
  int number() const { return number_; }  // of the last frame with depth

 private:
  struct Evidence {
    std::vector<float> log_odds, weights;  // of each cell
  };
  void AddDepth(int number, std::span<const float> depth, const Se3& T_camera_world,
                const History& history, Evidence& evidence) const;
  void AddFlow(std::span<const float> depth, std::span<const FlowTrack> tracks,
               std::span<const int8_t> votes, Evidence& evidence) const;
  void Spread(std::span<const float> depth, std::span<const uint8_t> suspect);

  const Cells& cells_;
  SurfaceBeliefSettings settings_;
  CellDepthSettings depth_settings_;
  int number_ = -1000;  // of the frame the belief is of
  std::vector<float> log_odds_;
  std::vector<float> certainty_;  // of each cell, 0…1: how much it was itself held against others
};

}  // namespace alidade
