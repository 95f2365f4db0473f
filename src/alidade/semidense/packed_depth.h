// Hypotheses of a keyframe's pixels at half their size, for keeping.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alidade/semidense/hypothesis.h"

namespace alidade {

// Inverse depths in steps of 1/65535 of the largest (at a tenth of it: 0.015 %, a tenth of what a
// search can tell), sigmas with 8 significant bits.
class PackedDepth {
 public:
  PackedDepth() = default;
  explicit PackedDepth(std::span<const Hypothesis> depth);

  // `growth`: what all inverse depths are multiplied by, for other units.
  std::vector<Hypothesis> Unpack(double growth = 1) const;
  size_t bytes() const { return packed_.capacity() * sizeof(Packed); }

 private:
  struct Packed {
    uint16_t inverse_depth = 0;
    uint16_t sigma = 0;  // upper half of the float; 0: nothing is known
  };
  float step_ = 0;
  std::vector<Packed> packed_;
};

}  // namespace alidade
