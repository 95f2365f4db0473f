// Reads the fields of a message in order: ROS 1 (little endian, no padding) or ROS 2 (CDR: numbers
// aligned to their size, after a 4-byte header that states the representation).
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

class MessageCursor {
 public:
  // Throws Error (input) for an unknown CDR representation and for Serialization::kOther.
  MessageCursor(std::string_view bytes, Serialization serialization);

  bool cdr() const { return cdr_; }

  // All throw Error (input) when the message is too short.
  std::string_view Take(uint64_t count);
  uint8_t Byte() { return static_cast<uint8_t>(Take(1)[0]); }
  uint32_t Uint32() { return static_cast<uint32_t>(Unsigned(4)); }
  double Double();
  std::string_view Text();
  std::string_view Bytes() { return Take(Uint32()); }

 private:
  void Align(size_t size);
  uint64_t Unsigned(size_t size);

  std::string_view body_;
  size_t at_ = 0;
  bool cdr_ = false;
  bool big_endian_ = false;
  size_t most_align_ = 1;
};

}  // namespace alidade
