// Reads protocol buffers' wire format, one field after the other, without copying.
// Protocol Buffers Encoding, developers.google.com.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace alidade {

struct ProtobufField {
  uint32_t number = 0;
  uint64_t value = 0;      // of integers
  std::string_view bytes;  // of strings and messages; of fixed-size values their 4 or 8 bytes
  bool is_integer = false;
};

class ProtobufReader {
 public:
  explicit ProtobufReader(std::string_view message) : rest_(message) {}

  // The next field; none at the end, and none when the message is damaged from here on.
  std::optional<ProtobufField> Next();
  bool damaged() const { return damaged_; }

  // For packed fields: the next of integers that stand one behind the other.
  std::optional<uint64_t> TakeInteger();

 private:
  std::optional<std::string_view> TakeBytes(uint64_t count);

  std::string_view rest_;
  bool damaged_ = false;
};

// Of a repeated integer field, which may be written one by one or packed: the first `most`. What is
// damaged of it is left out.
std::vector<uint64_t> Integers(const ProtobufField& field, size_t most);
// How many there are.
uint64_t CountIntegers(const ProtobufField& field);

}  // namespace alidade
