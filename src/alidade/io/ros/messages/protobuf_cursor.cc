#include "alidade/io/ros/messages/protobuf_cursor.h"

#include "alidade/base/error.h"

namespace alidade {

std::string_view ProtobufCursor::Take(uint64_t count) {
  if (count > left_.size()) ThrowInput("is truncated");
  const std::string_view taken = left_.substr(0, count);
  left_.remove_prefix(count);
  return taken;
}

// Groups of 7 bits, the lowest first; the highest bit of a byte says that another follows.
uint64_t ProtobufCursor::Varint() {
  uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const auto byte = static_cast<uint8_t>(Take(1)[0]);
    value |= static_cast<uint64_t>(byte & 127) << shift;
    if ((byte & 128) == 0) return value;
  }
  ThrowInput("is damaged: a number has no end");
}

std::optional<ProtobufCursor::Field> ProtobufCursor::Next() {
  if (left_.empty()) return std::nullopt;
  const uint64_t key = Varint();
  Field field;
  field.number = static_cast<uint32_t>(key >> 3);
  const auto fixed = [&](size_t size) {
    const std::string_view bytes = Take(size);
    for (size_t i = size; i-- > 0;) field.value = field.value << 8 | static_cast<uint8_t>(bytes[i]);
  };
  switch (key & 7) {
    case 0:
      field.value = Varint();
      break;
    case 1:
      fixed(8);
      break;
    case 2:
      field.bytes = Take(Varint());
      field.is_bytes = true;
      break;
    case 5:
      fixed(4);
      break;
    default:
      ThrowInput("is damaged: a field has an unknown kind");
  }
  return field;
}

}  // namespace alidade
