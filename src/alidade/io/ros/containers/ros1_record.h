// A record of a ROS bag 2.0: header length, header (`name=value` fields, each with its length),
// data length, data.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "alidade/io/ros/containers/byte_source.h"

namespace alidade {

enum class Ros1Op : uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndexData = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

// Parsed `name=value` fields.
class Ros1Fields {
 public:
  explicit Ros1Fields(std::string bytes);  // throws Error (input)
  bool Has(const std::string& name) const { return values_.count(name) != 0; }
  // Throws Error (input) when the field is missing.
  std::string Text(const std::string& name) const;
  // The field as a little-endian integer of sizeof(T) bytes; throws Error (input) otherwise.
  template <typename T>
  T Number(const std::string& name) const {
    return static_cast<T>(Bits(name, sizeof(T)));
  }
  Ros1Op Op() const { return static_cast<Ros1Op>(Number<uint8_t>("op")); }
  int64_t Time() const;  // field `time`, converted to nanoseconds

 private:
  uint64_t Bits(const std::string& name, size_t bytes) const;
  std::map<std::string, std::string> values_;
};

// A record in a file.
struct Ros1Record {
  Ros1Fields fields;
  uint64_t data_at = 0;
  uint32_t data_size = 0;
  uint64_t End() const { return data_at + data_size; }
};
// The record's data may extend past the end of the file.
Ros1Record ReadRos1Record(const ByteSource& source, uint64_t at);

// Reads a record of an unpacked chunk at position `at`, and moves `at` past it.
struct Ros1Item {
  Ros1Fields fields;
  std::string_view data;
};
Ros1Item TakeRos1Item(std::string_view chunk, uint64_t& at);

int64_t Ros1Time(uint64_t bits);  // nanoseconds; low 32 bits: seconds, high 32 bits: nanoseconds

}  // namespace alidade
