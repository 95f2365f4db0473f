// Reads the fields of a message in the encoding of Protocol Buffers: pairs of a field's number and
// its value, in any order.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace alidade {

class ProtobufCursor {
 public:
  struct Field {
    uint32_t number = 0;
    uint64_t value = 0;      // of numbers, those of floating point as bits; 0 for others
    bool is_bytes = false;   // `bytes` holds the value
    std::string_view bytes;  // of texts, bytes and messages
  };

  explicit ProtobufCursor(std::string_view bytes) : left_(bytes) {}
  // nullopt at the end. Throws Error (input) when the message is damaged, or ends within a field.
  std::optional<Field> Next();

 private:
  uint64_t Varint();
  std::string_view Take(uint64_t count);

  std::string_view left_;
};

}  // namespace alidade
