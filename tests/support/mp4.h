// Edits MP4 files (ISO 14496-12) to produce features that OpenCV's writer does not support.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace alidade {

inline uint32_t Mp4Number(const std::string& bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

inline std::string Mp4Text(uint32_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8)
    text.push_back(static_cast<char>((value >> shift) & 0xff));
  return text;
}

// Start of a box (its size field).
inline size_t Mp4Box(const std::string& bytes, const std::string& type) {
  return bytes.rfind(type) - 4;
}

// Sets the duration of each frame in units of the track's time scale. The index must follow the
// media data (as FFmpeg writes it), because it grows.
inline void SetMp4Durations(std::string& bytes, const std::vector<uint32_t>& durations) {
  std::string stts = "stts" + Mp4Text(0) + Mp4Text(static_cast<uint32_t>(durations.size()));
  for (const uint32_t duration : durations) stts += Mp4Text(1) + Mp4Text(duration);
  stts = Mp4Text(static_cast<uint32_t>(stts.size() + 4)) + stts;
  const size_t at = Mp4Box(bytes, "stts");
  const uint32_t old_size = Mp4Number(bytes, at);
  bytes.replace(at, old_size, stts);
  for (const char* parent : {"moov", "trak", "mdia", "minf", "stbl"}) {
    const size_t box = Mp4Box(bytes, parent);
    bytes.replace(box, 4,
                  Mp4Text(Mp4Number(bytes, box) + static_cast<uint32_t>(stts.size()) - old_size));
  }
}

// Sets the display matrix: the pixel (x, y) is shown at (a x + c y, b x + d y), each of -1, 0, 1.
inline void SetMp4DisplayMatrix(std::string& bytes, int a, int b, int c, int d) {
  const auto fixed = [](int value) { return static_cast<uint32_t>(value * 0x10000); };
  const uint32_t one_w = 0x40000000;
  std::string matrix;
  for (const uint32_t value : {fixed(a), fixed(b), 0u, fixed(c), fixed(d), 0u, 0u, 0u, one_w})
    matrix += Mp4Text(value);
  bytes.replace(Mp4Box(bytes, "tkhd") + 48, matrix.size(), matrix);  // version 0 of the box
}

// Sets the rotation flag to a clockwise quarter turn.
inline void SetMp4QuarterTurn(std::string& bytes) { SetMp4DisplayMatrix(bytes, 0, 1, -1, 0); }

// Sets the edit list to one segment, from `start` on. Seconds; the file has an edit list, and one
// track.
inline void SetMp4Edit(std::string& bytes, double start, double duration) {
  // Version 0 of all boxes. Segments have the movie's time scale, starts the track's.
  const uint32_t movie = Mp4Number(bytes, Mp4Box(bytes, "mvhd") + 20);
  const uint32_t track = Mp4Number(bytes, Mp4Box(bytes, "mdhd") + 20);
  bytes.replace(Mp4Box(bytes, "elst") + 12, 12,
                Mp4Text(1) + Mp4Text(static_cast<uint32_t>(duration * movie + 0.5)) +
                    Mp4Text(static_cast<uint32_t>(start * track + 0.5)));
}

}  // namespace alidade
