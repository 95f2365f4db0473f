// Values as ROS 2 puts them on the wire: CDR, little-endian. Four bytes that say so come first;
// from there on each number lies at a multiple of its size.
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

  // A number, or bool as one byte.
  template <typename T>
  void Add(T value) {
    static_assert(std::is_arithmetic_v<T>);
    while ((bytes_.size() - sizeof kStart) % sizeof(T) != 0) bytes_.push_back('\0');
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));  // all machines this is compiled for are little-endian
    bytes_.append(raw, sizeof(T));
  }
  // Length with the zero at its end, then both.
  void AddText(std::string_view text) {
    AddCount(text.size() + 1);
    bytes_.append(text);
    bytes_.push_back('\0');
  }
  // uint8[]: length, then all of it.
  void AddBytes(std::string_view bytes) {
    AddCount(bytes.size());
    bytes_.append(bytes);
  }
  // What a sequence begins with; its elements follow.
  void AddCount(size_t count) { Add(static_cast<uint32_t>(count)); }

  std::string Take() { return std::move(bytes_); }

 private:
  static constexpr char kStart[4] = {0, 1, 0, 0};  // CDR_LE, no options
  std::string bytes_;
};

}  // namespace alidade
