// Hypotheses of a keyframe in a compact form of half the size.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alidade/semidense/hypothesis.h"

namespace alidade {

// Inverse depths in steps of 1/65535 of the largest (0.015 % at a tenth of it, a tenth of the
// accuracy of a search); sigmas with 8 significant bits.
class PackedDepth {
 public:
  PackedDepth() = default;
  explicit PackedDepth(std::span<const Hypothesis> depth);

  // `growth`: factor applied to all inverse depths and sigmas, for a change of scale.
  std::vector<Hypothesis> Unpack(double growth = 1) const;
  size_t bytes() const { return packed_.capacity() * sizeof(Packed); }

 private:
  struct Packed {
    uint16_t inverse_depth = 0;
    uint16_t sigma = 0;  // upper half of the float; 0: unknown
  };
  float step_ = 0;
  std::vector<Packed> packed_;
};

}  // namespace alidade
