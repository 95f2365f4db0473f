#include <zlib.h>

#include "alidade/base/error.h"
#include "fuzz/targets.h"
#include "fuzz/use_decoded.h"

namespace alidade::fuzz {
namespace {

uint32_t BigEndian(std::string_view bytes) {
  uint32_t value = 0;
  for (const char byte : bytes.substr(0, 4)) value = value << 8 | static_cast<uint8_t>(byte);
  return value;
}

// A chunk is a length, a name, that many bytes, and a CRC of name and bytes; libpng stops at a
// wrong CRC.
std::string WithCrcsThatFit(std::string_view bytes) {
  std::string repaired(bytes);
  for (size_t at = 8; at + 12 <= bytes.size();) {
    const size_t length = BigEndian(bytes.substr(at));
    if (length > bytes.size() - at - 12) break;
    const auto* named = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    const auto crc = static_cast<uint32_t>(crc32(0, named, static_cast<uInt>(length + 4)));
    for (size_t i = 0; i < 4; ++i)
      repaired[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
    at += length + 12;
  }
  return repaired;
}

}  // namespace

void Png(std::string_view bytes) {
  if (!LooksLikePng(bytes)) ThrowInput("is no PNG");
  UseDecoded(WithCrcsThatFit(bytes), DecodePng, PngSize(WithCrcsThatFit(bytes)));
}

}  // namespace alidade::fuzz
