#include "alidade/io/ros/messages/message_cursor.h"

#include <algorithm>

#include "alidade/base/error.h"

namespace alidade {

MessageCursor::MessageCursor(std::string_view bytes, Serialization serialization) : body_(bytes) {
  if (serialization == Serialization::kRos1) return;
  if (serialization != Serialization::kCdr) ThrowInput("is encoded neither as in ROS 1 nor as CDR");
  cdr_ = true;
  const std::string_view head = Take(4);
  // Representation identifiers: 0 and 1 are plain CDR, big and little endian; 6 and 7 are CDR
  // version 2, which aligns 8-byte numbers to 4 bytes only.
  const auto kind =
      static_cast<unsigned>(static_cast<uint8_t>(head[0])) << 8 | static_cast<uint8_t>(head[1]);
  if (kind != 0 && kind != 1 && kind != 6 && kind != 7)
    ThrowInput("is damaged, or of an unknown kind of CDR");
  big_endian_ = kind % 2 == 0;
  most_align_ = kind < 6 ? 8 : 4;
  body_.remove_prefix(4);
  at_ = 0;
}

std::string_view MessageCursor::Take(uint64_t count) {
  if (count > body_.size() - at_) ThrowInput("is truncated");
  const std::string_view taken = body_.substr(at_, count);
  at_ += count;
  return taken;
}

void MessageCursor::Align(size_t size) {
  const size_t step = std::min(size, most_align_);
  Take((step - at_ % step) % step);
}

uint64_t MessageCursor::Unsigned(size_t size) {
  Align(size);
  const std::string_view bytes = Take(size);
  uint64_t value = 0;
  for (size_t i = 0; i < size; ++i) {
    const char byte = bytes[big_endian_ ? i : size - 1 - i];
    value = value << 8 | static_cast<uint8_t>(byte);
  }
  return value;
}

double MessageCursor::Double() {
  const uint64_t bits = Unsigned(8);
  double value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

std::string_view MessageCursor::Text() {
  std::string_view text = Bytes();
  if (cdr_ && !text.empty()) text.remove_suffix(1);  // CDR strings end with a zero byte
  return text;
}

}  // namespace alidade
