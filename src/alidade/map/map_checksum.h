// Constants and checksum of the map format, shared by map_encode.cc and map_decode.cc only.
#pragma once

#include <cstddef>
#include <cstdint>

namespace alidade {

// Version 1 (still readable): one map, no loops, no places.
// Version 2: several maps with their scales and loops, and the place vocabulary.
inline constexpr uint32_t kMapVersion = 2;

// 64-bit FNV-1a of `size` bytes, with the bytes in [skip, skip + 8) (the checksum field) taken as
// zero.
inline uint64_t MapChecksum(const uint8_t* bytes, size_t size, size_t skip) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (size_t i = 0; i < size; ++i) {
    // Unsigned arithmetic: smaller i wrap around to large numbers.
    hash ^= i - skip < 8 ? 0 : bytes[i];
    hash *= 0x100000001b3u;
  }
  return hash;
}

}  // namespace alidade
