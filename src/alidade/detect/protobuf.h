// Reader of the protocol buffers wire format, field by field, without copying.
// Protocol Buffers Encoding, developers.google.com.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace alidade {

struct ProtobufField {
  uint32_t number = 0;
  uint64_t value = 0;      // of an integer field
  std::string_view bytes;  // of a string or message; for fixed-size values their 4 or 8 bytes
  bool is_integer = false;
};

class ProtobufReader {
 public:
  explicit ProtobufReader(std::string_view message) : rest_(message) {}

  // The next field; nullopt at the end, and when the message is damaged from here on.
  std::optional<ProtobufField> Next();
  bool damaged() const { return damaged_; }

  // The next varint; used for packed fields.
  std::optional<uint64_t> TakeInteger();

 private:
  std::optional<std::string_view> TakeBytes(uint64_t count);

  std::string_view rest_;
  bool damaged_ = false;
};

// The first `most` values of a repeated integer field, packed or not. Damaged values are skipped.
std::vector<uint64_t> Integers(const ProtobufField& field, size_t most);
// Number of values.
uint64_t CountIntegers(const ProtobufField& field);

}  // namespace alidade
