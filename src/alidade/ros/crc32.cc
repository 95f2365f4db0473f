#include "alidade/ros/crc32.h"

#include <array>

namespace alidade {
namespace {

// Remainder of each byte value.
constexpr std::array<uint32_t, 256> RemaindersOfBytes() {
  std::array<uint32_t, 256> table{};
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit)
      remainder = remainder >> 1 ^ ((remainder & 1) != 0 ? 0xedb88320u : 0);
    table[byte] = remainder;
  }
  return table;
}

constexpr std::array<uint32_t, 256> kRemainders = RemaindersOfBytes();

}  // namespace

uint32_t Crc32(std::string_view bytes, uint32_t before) {
  uint32_t remainder = ~before;
  for (const char byte : bytes)
    remainder = kRemainders[(remainder ^ static_cast<uint8_t>(byte)) & 0xff] ^ remainder >> 8;
  return ~remainder;
}

}  // namespace alidade
