// Parsers of the MCAP records needed to read messages.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/io/ros/containers/byte_cursor.h"
#include "alidade/io/ros/containers/byte_source.h"

namespace alidade {

enum class McapOp : uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 0x0b,
  kDataEnd = 0x0f
};

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
inline constexpr uint64_t kMcapRecordHead = 9;    // bytes: opcode and length
inline constexpr uint64_t kMcapMessageHead = 22;  // bytes: channel, sequence, two times

// A record in a file. Its content may extend past the end of the file.
struct McapRecord {
  McapOp op = McapOp::kHeader;
  uint64_t content_at = 0, size = 0;
  uint64_t End() const { return content_at + size; }
};
McapRecord ReadMcapRecord(const ByteSource& source, uint64_t at);

// A record in an unpacked chunk or in the summary.
struct McapItem {
  McapOp op = McapOp::kHeader;
  std::string_view content;
};
McapItem TakeMcapItem(ByteCursor& cursor);

struct McapSchema {
  uint16_t id = 0;
  std::string name;
};
McapSchema ParseMcapSchema(std::string_view content);

struct McapChannel {
  uint16_t id = 0, schema = 0;
  std::string topic, encoding;
};
McapChannel ParseMcapChannel(std::string_view content);

struct McapMessage {
  uint16_t channel = 0;
  int64_t log_time = 0;  // nanoseconds
  std::string_view data;
};
McapMessage ParseMcapMessage(std::string_view content);

// Header of a chunk record, before the chunk's own records.
struct McapChunkHead {
  uint64_t unpacked_size = 0;
  uint32_t crc = 0;  // CRC-32 of the unpacked records; 0: not stated
  std::string compression;
  uint64_t records_at = 0, records_size = 0;  // position in the file and packed size, bytes
};
McapChunkHead ReadMcapChunkHead(const ByteSource& source, const McapRecord& chunk);

struct McapChunkIndex {
  uint64_t chunk_at = 0, chunk_size = 0;  // of the whole record, bytes
  uint64_t index_size = 0;                // bytes of the message indexes after the chunk
};
McapChunkIndex ParseMcapChunkIndex(std::string_view content);

struct McapIndexEntry {
  int64_t log_time = 0;
  uint64_t offset = 0;  // position in the unpacked chunk, bytes
};
struct McapMessageIndex {
  uint16_t channel = 0;
  std::vector<McapIndexEntry> entries;
};
McapMessageIndex ParseMcapMessageIndex(std::string_view content);

}  // namespace alidade
