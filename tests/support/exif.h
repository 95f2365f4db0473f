// EXIF data that tells a focal length, as a segment of a JPEG.
#pragma once

#include <cstdint>
#include <string>

namespace alidade {

// The last `bytes` bytes of a number, the highest first.
inline std::string Big(uint64_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i)
    text += static_cast<char>(i < 8 ? value >> (8 * i) : uint64_t{0});
  return text;
}

// APP1, to be put after the first two bytes of a JPEG: a TIFF directory that refers to another one
// with a single entry: FocalLengthIn35mmFilm (0xA405).
inline std::string Exif(uint16_t millimetres) {
  const std::string tiff = "MM" + Big(42, 2) + Big(8, 4) + Big(1, 2) + Big(0x8769, 2) + Big(4, 2) +
                           Big(1, 4) + Big(26, 4) + Big(0, 4) + Big(1, 2) + Big(0xA405, 2) +
                           Big(3, 2) + Big(1, 4) + Big(millimetres, 2) + Big(0, 2) + Big(0, 4);
  const std::string body = std::string("Exif\0\0", 6) + tiff;
  return "\xFF\xE1" + Big(static_cast<uint32_t>(body.size()) + 2, 2) + body;
}

}  // namespace alidade
