#include "alidade/detect/protobuf.h"

namespace alidade {
namespace {

enum WireType { kVarint = 0, kFixed64 = 1, kLengthDelimited = 2, kFixed32 = 5 };

}  // namespace

std::optional<uint64_t> ProtobufReader::TakeInteger() {
  uint64_t value = 0;
  for (int shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
    const auto byte = static_cast<unsigned char>(rest_.front());
    rest_.remove_prefix(1);
    value |= static_cast<uint64_t>(byte & 0x7f) << shift;
    if (byte < 0x80) return value;
  }
  return std::nullopt;
}

std::optional<std::string_view> ProtobufReader::TakeBytes(uint64_t count) {
  if (count > rest_.size()) return std::nullopt;
  const std::string_view bytes = rest_.substr(0, count);
  rest_.remove_prefix(count);
  return bytes;
}

std::optional<ProtobufField> ProtobufReader::Next() {
  if (damaged_ || rest_.empty()) return std::nullopt;
  damaged_ = true;  // reset once the field is complete
  const std::optional<uint64_t> key = TakeInteger();
  if (!key || *key >> 3 == 0 || *key >> 32 != 0) return std::nullopt;
  ProtobufField field;
  field.number = static_cast<uint32_t>(*key >> 3);
  std::optional<uint64_t> size;
  switch (*key & 7) {
    case kVarint: {
      const std::optional<uint64_t> value = TakeInteger();
      if (!value) return std::nullopt;
      field.value = *value;
      field.is_integer = true;
      damaged_ = false;
      return field;
    }
    case kFixed64:
      size = 8;
      break;
    case kFixed32:
      size = 4;
      break;
    case kLengthDelimited:
      size = TakeInteger();
      break;
    default:
      break;  // groups, which are deprecated
  }
  const std::optional<std::string_view> bytes = size ? TakeBytes(*size) : std::nullopt;
  if (!bytes) return std::nullopt;
  field.bytes = *bytes;
  damaged_ = false;
  return field;
}

std::vector<uint64_t> Integers(const ProtobufField& field, size_t most) {
  if (field.is_integer) return {field.value};
  std::vector<uint64_t> integers;
  ProtobufReader reader(field.bytes);
  while (integers.size() < most) {
    const std::optional<uint64_t> integer = reader.TakeInteger();
    if (!integer) break;
    integers.push_back(*integer);
  }
  return integers;
}

uint64_t CountIntegers(const ProtobufField& field) {
  if (field.is_integer) return 1;
  uint64_t count = 0;
  ProtobufReader reader(field.bytes);
  while (reader.TakeInteger()) ++count;
  return count;
}

}  // namespace alidade
