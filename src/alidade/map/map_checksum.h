// What reading and writing a map must agree on. For map_encode.cc and map_decode.cc only.
#pragma once

#include <cstddef>
#include <cstdint>

namespace alidade {

// 1: one map, no loops, no places; still read.
// 2: several maps, their scales and loops, the vocabulary of places.
inline constexpr uint32_t kMapVersion = 2;

// FNV-1a, 64 bit, of `size` bytes, those in [skip, skip + 8) taken as zero: the checksum's own
// place.
inline uint64_t MapChecksum(const uint8_t* bytes, size_t size, size_t skip) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (size_t i = 0; i < size; ++i) {
    hash ^= i - skip < 8 ? 0 : bytes[i];  // unsigned: smaller i wrap round to large numbers
    hash *= 0x100000001b3u;
  }
  return hash;
}

}  // namespace alidade
