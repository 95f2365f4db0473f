// Modifies the bytes of a saved map, using FlatBuffers' layout only.
#pragma once

#include <cstring>
#include <optional>
#include <string>

#include "alidade/map/map_checksum.h"

namespace alidade {

// Position of a field of the root table; nullopt when damage has moved it outside.
inline std::optional<size_t> RootField(const std::string& bytes, size_t field, size_t size) {
  const auto read = [&](size_t at, auto value) -> std::optional<decltype(value)> {
    if (at > bytes.size() || bytes.size() - at < sizeof(value)) return std::nullopt;
    std::memcpy(&value, bytes.data() + at, sizeof(value));
    return value;
  };
  const auto table = read(0, uint32_t{});
  const auto to_vtable = table ? read(*table, int32_t{}) : std::nullopt;
  if (!to_vtable) return std::nullopt;
  const auto vtable = static_cast<size_t>(int64_t{*table} - *to_vtable);
  const auto length = read(vtable, uint16_t{});
  if (!length || *length < 6 + 2 * field) return std::nullopt;
  const auto offset = read(vtable + 4 + 2 * field, uint16_t{});
  if (!offset || *offset == 0) return std::nullopt;
  const size_t place = *table + *offset;
  if (place > bytes.size() || bytes.size() - place < size) return std::nullopt;
  return place;
}

// Updates the checksum to match the bytes. Returns false when its position cannot be found.
inline bool RepairChecksum(std::string& bytes) {
  const auto place = RootField(bytes, 1, sizeof(uint64_t));
  if (!place) return false;
  const uint64_t checksum =
      MapChecksum(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), *place);
  std::memcpy(bytes.data() + *place, &checksum, sizeof(checksum));
  return true;
}

inline void SetMapVersion(std::string& bytes, uint32_t version) {
  std::memcpy(bytes.data() + RootField(bytes, 0, sizeof(version)).value(), &version,
              sizeof(version));
}

}  // namespace alidade
