// 256-bit binary descriptors and their Hamming distance.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct Descriptor {
  std::array<uint64_t, 4> words{};
  friend bool operator==(const Descriptor&, const Descriptor&) = default;
};

inline int HammingDistance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a.words[0] ^ b.words[0]) + std::popcount(a.words[1] ^ b.words[1]) +
         std::popcount(a.words[2] ^ b.words[2]) + std::popcount(a.words[3] ^ b.words[3]);
}

}  // namespace alidade
