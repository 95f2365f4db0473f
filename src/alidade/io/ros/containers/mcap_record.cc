#include "alidade/io/ros/containers/mcap_record.h"

#include <algorithm>
#include <limits>

namespace alidade {
namespace {

// MCAP's unsigned nanoseconds; values after the year 2262 are clamped to the largest int64_t.
int64_t TakeTime(ByteCursor& cursor) {
  return static_cast<int64_t>(
      std::min<uint64_t>(cursor.Number<uint64_t>(), std::numeric_limits<int64_t>::max()));
}

}  // namespace

McapRecord ReadMcapRecord(const ByteSource& source, uint64_t at) {
  const std::string head = source.Read(at, kMcapRecordHead);
  ByteCursor cursor(head);
  McapRecord record;
  record.op = static_cast<McapOp>(cursor.Number<uint8_t>());
  record.content_at = at + kMcapRecordHead;
  record.size = cursor.Number<uint64_t>();
  if (record.size > std::numeric_limits<uint64_t>::max() / 2)
    ThrowInput("is damaged: a record is too long");
  return record;
}

McapItem TakeMcapItem(ByteCursor& cursor) {
  const auto op = static_cast<McapOp>(cursor.Number<uint8_t>());
  return {op, cursor.Sized<uint64_t>()};
}

McapSchema ParseMcapSchema(std::string_view content) {
  ByteCursor cursor(content);
  McapSchema schema;
  schema.id = cursor.Number<uint16_t>();
  schema.name = cursor.Sized<uint32_t>();
  return schema;
}

McapChannel ParseMcapChannel(std::string_view content) {
  ByteCursor cursor(content);
  McapChannel channel;
  channel.id = cursor.Number<uint16_t>();
  channel.schema = cursor.Number<uint16_t>();
  channel.topic = cursor.Sized<uint32_t>();
  channel.encoding = cursor.Sized<uint32_t>();
  return channel;
}

McapMessage ParseMcapMessage(std::string_view content) {
  ByteCursor cursor(content);
  McapMessage message;
  message.channel = cursor.Number<uint16_t>();
  cursor.Number<uint32_t>();  // sequence number
  message.log_time = TakeTime(cursor);
  cursor.Number<uint64_t>();  // publish time
  message.data = cursor.Take(cursor.Left());
  return message;
}

McapChunkHead ReadMcapChunkHead(const ByteSource& source, const McapRecord& chunk) {
  // Start and end time, unpacked size, CRC, name of the compression (a few letters), packed size.
  const std::string bytes = source.Read(chunk.content_at, std::min<uint64_t>(chunk.size, 100));
  ByteCursor cursor(bytes);
  cursor.Take(16);
  McapChunkHead head;
  head.unpacked_size = cursor.Number<uint64_t>();
  head.crc = cursor.Number<uint32_t>();
  head.compression = cursor.Sized<uint32_t>();
  head.records_size = cursor.Number<uint64_t>();
  head.records_at = chunk.content_at + bytes.size() - cursor.Left();
  if (head.records_size > chunk.End() - head.records_at)
    ThrowInput("is damaged: a chunk is longer than its record");
  return head;
}

McapChunkIndex ParseMcapChunkIndex(std::string_view content) {
  ByteCursor cursor(content);
  cursor.Take(16);  // time of the first and of the last message
  McapChunkIndex index;
  index.chunk_at = cursor.Number<uint64_t>();
  index.chunk_size = cursor.Number<uint64_t>();
  // Offsets of each channel's message index; not needed, because the indexes are read one after
  // another.
  cursor.Sized<uint32_t>();
  index.index_size = cursor.Number<uint64_t>();
  return index;
}

McapMessageIndex ParseMcapMessageIndex(std::string_view content) {
  ByteCursor cursor(content);
  McapMessageIndex index;
  index.channel = cursor.Number<uint16_t>();
  for (ByteCursor entries(cursor.Sized<uint32_t>()); !entries.AtEnd();) {
    const int64_t time = TakeTime(entries);
    index.entries.push_back({time, entries.Number<uint64_t>()});
  }
  return index;
}

}  // namespace alidade
