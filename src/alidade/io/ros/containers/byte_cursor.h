// Reads little-endian numbers and length-prefixed strings from untrusted bytes. Every length is
// checked against the remaining bytes before use.
#pragma once

#include <cstdint>
#include <string_view>

#include "alidade/base/error.h"

namespace alidade {

class ByteCursor {
 public:
  explicit ByteCursor(std::string_view bytes) : rest_(bytes) {}

  bool AtEnd() const { return rest_.empty(); }
  size_t Left() const { return rest_.size(); }

  std::string_view Take(uint64_t count) {
    if (count > rest_.size()) ThrowInput("is truncated, or a length in it is wrong");
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }

  // The next sizeof(T) bytes as an unsigned little-endian integer.
  template <typename T>
  T Number() {
    const std::string_view bytes = Take(sizeof(T));
    uint64_t value = 0;
    for (size_t i = sizeof(T); i-- > 0;) value = value << 8 | static_cast<uint8_t>(bytes[i]);
    return static_cast<T>(value);
  }

  // Bytes preceded by their number as a `Length`.
  template <typename Length>
  std::string_view Sized() {
    return Take(Number<Length>());
  }

 private:
  std::string_view rest_;
};

}  // namespace alidade
