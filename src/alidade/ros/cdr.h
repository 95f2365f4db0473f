// Encodes values in ROS 2's wire format: little-endian CDR. A 4-byte header states the
// representation; after it each number is aligned to its size.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace alidade {

class CdrWriter {
 public:
  CdrWriter() : bytes_(kStart, sizeof kStart) {}

  // Appends a number, or a bool as one byte.
  template <typename T>
  void Add(T value) {
    static_assert(std::is_arithmetic_v<T>);
    while ((bytes_.size() - sizeof kStart) % sizeof(T) != 0) bytes_.push_back('\0');
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));  // all supported machines are little-endian
    bytes_.append(raw, sizeof(T));
  }
  // A string: length including the terminating zero, the bytes, the zero.
  void AddText(std::string_view text) {
    AddCount(text.size() + 1);
    bytes_.append(text);
    bytes_.push_back('\0');
  }
  // uint8[]: length, then the bytes.
  void AddBytes(std::string_view bytes) {
    AddCount(bytes.size());
    bytes_.append(bytes);
  }
  // The length of a sequence, before its elements.
  void AddCount(size_t count) { Add(static_cast<uint32_t>(count)); }

  std::string Take() { return std::move(bytes_); }

 private:
  static constexpr char kStart[4] = {0, 1, 0, 0};  // CDR_LE, no options
  std::string bytes_;
};

}  // namespace alidade
