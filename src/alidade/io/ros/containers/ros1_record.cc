#include "alidade/io/ros/containers/ros1_record.h"

#include "alidade/base/error.h"
#include "alidade/io/ros/containers/byte_cursor.h"

namespace alidade {
namespace {

constexpr uint32_t kMostHeader = 1 << 20;  // bytes; the topic's name is the longest field

}  // namespace

Ros1Fields::Ros1Fields(std::string bytes) {
  for (ByteCursor cursor(bytes); !cursor.AtEnd();) {
    const std::string_view field = cursor.Sized<uint32_t>();
    const size_t equals = field.find('=');
    if (equals == std::string_view::npos) ThrowInput("is damaged: a field without `=`");
    values_[std::string(field.substr(0, equals))] = std::string(field.substr(equals + 1));
  }
}

std::string Ros1Fields::Text(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) ThrowInput("is damaged: a record without `" + name + "`");
  return found->second;
}

uint64_t Ros1Fields::Bits(const std::string& name, size_t bytes) const {
  const std::string text = Text(name);
  if (text.size() != bytes) ThrowInput("is damaged: `" + name + "` has the wrong length");
  uint64_t value = 0;
  for (size_t i = bytes; i-- > 0;) value = value << 8 | static_cast<uint8_t>(text[i]);
  return value;
}

int64_t Ros1Fields::Time() const { return Ros1Time(Number<uint64_t>("time")); }

int64_t Ros1Time(uint64_t bits) {
  return static_cast<int64_t>(bits & 0xffffffff) * 1'000'000'000 + static_cast<int64_t>(bits >> 32);
}

Ros1Record ReadRos1Record(const ByteSource& source, uint64_t at) {
  const std::string start = source.Read(at, 4);
  const auto header_size = ByteCursor(start).Number<uint32_t>();
  if (header_size > kMostHeader) ThrowInput("is damaged: a record's header is too long");
  const std::string header = source.Read(at + 4, uint64_t{header_size} + 4);
  Ros1Record record{Ros1Fields(header.substr(0, header_size))};
  record.data_at = at + 8 + header_size;
  record.data_size = ByteCursor(std::string_view(header).substr(header_size)).Number<uint32_t>();
  return record;
}

Ros1Item TakeRos1Item(std::string_view chunk, uint64_t& at) {
  if (at > chunk.size()) ThrowInput("is damaged: a message lies past the end of its chunk");
  ByteCursor cursor(chunk.substr(at));
  const size_t before = cursor.Left();
  Ros1Fields fields{std::string(cursor.Sized<uint32_t>())};
  const std::string_view data = cursor.Sized<uint32_t>();
  at += before - cursor.Left();
  return {std::move(fields), data};
}

}  // namespace alidade
