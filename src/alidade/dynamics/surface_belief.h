// Probability of each cell to be static, where depth is measured.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/flow_tracks.h"
#include "alidade/dynamics/history.h"

namespace alidade {

// Belief is expressed as log-odds of being static, l = ln(p / (1 - p)).
inline constexpr float kUnknownStatic = 1.5f;  // without evidence: p = 0.82
inline constexpr float kCertainStatic = 5;     // bound of all log-odds: p = 0.993
inline constexpr float kObjectStatic = -4;     // of a detected object of a moving class: p = 0.018
inline constexpr float kRestingStatic = -0.85f;  // upper bound for a resting object: p = 0.3

class SurfaceBelief {
 public:
  // Keeps a reference to `cells`.
  explicit SurfaceBelief(const Cells& cells, const SurfaceBeliefSettings& settings = {},
                         const CellDepthSettings& depth_settings = {});

  // Carries the belief to the current frame: each cell takes over the belief of the cell of the
  // last frame with depth that shows the same position, assuming that moving objects are large
  // compared to their motion per frame. Returns that cell for each cell, or -1.
  std::vector<int> Carry(std::span<const float> depth, const Se3& T_camera_world,
                         const History& history);
  // Adds the evidence of this frame. `resting`: cells (nonzero) on an object of a moving class;
  // evidence that they are static is ignored. `suspect`: cells (nonzero) in the box of a detected
  // object; only there can neighbors alone lower a cell below spread_least. `votes`: Consensus() of
  // the tracks.
  void Update(int number, std::span<const float> depth, const Se3& T_camera_world,
              const History& history, std::span<const uint8_t> resting,
              std::span<const uint8_t> suspect, std::span<const FlowTrack> tracks,
              std::span<const int8_t> votes);
  const std::vector<float>& log_odds() const { return log_odds_; }
  int number() const { return number_; }  // of the last frame with depth

 private:
  struct Evidence {
    std::vector<float> log_odds, weights;  // per cell
  };
  void AddDepth(int number, std::span<const float> depth, const Se3& T_camera_world,
                const History& history, Evidence& evidence) const;
  void AddFlow(std::span<const float> depth, std::span<const FlowTrack> tracks,
               std::span<const int8_t> votes, Evidence& evidence) const;
  void Spread(std::span<const float> depth, std::span<const uint8_t> suspect);

  const Cells& cells_;
  SurfaceBeliefSettings settings_;
  CellDepthSettings depth_settings_;
  int number_ = -1000;  // of the frame the belief refers to
  std::vector<float> log_odds_;
  std::vector<float> certainty_;  // of each cell, 0…1: amount of its own evidence
};

}  // namespace alidade
