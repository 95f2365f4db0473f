#include "alidade/ros/mcap_writer.h"

#include <algorithm>
#include <cstring>

#include "alidade/ros/crc32.h"

namespace alidade {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

enum Opcode : uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f
};

template <typename T>
void Append(T value, std::string& out) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);  // little-endian, as all supported machines are
  out.append(raw, sizeof value);
}

void AppendText(std::string_view text, std::string& out) {
  Append(static_cast<uint32_t>(text.size()), out);
  out.append(text);
}

// A record: opcode, length, content.
std::string Record(Opcode opcode, std::string_view content) {
  std::string record(1, static_cast<char>(opcode));
  Append(static_cast<uint64_t>(content.size()), record);
  record.append(content);
  return record;
}

// A map in MCAP's encoding: total length, then the pairs.
std::string MapOf(const std::map<uint16_t, uint64_t>& pairs) {
  std::string out;
  Append(static_cast<uint32_t>(pairs.size() * (sizeof(uint16_t) + sizeof(uint64_t))), out);
  for (const auto& [key, value] : pairs) {
    Append(key, out);
    Append(value, out);
  }
  return out;
}

}  // namespace

McapWriter::McapWriter(Sink sink, const std::string& profile, const std::string& library,
                       McapCompression compression, size_t chunk_bytes)
    : sink_(std::move(sink)), compression_(std::move(compression)), chunk_bytes_(chunk_bytes) {
  std::string header;
  AppendText(profile, header);
  AppendText(library, header);
  Put(kMagic);
  Put(Record(kHeader, header));
}

void McapWriter::Put(std::string_view bytes) {
  sink_(bytes);
  crc_ = Crc32(bytes, crc_);
  position_ += bytes.size();
}

uint16_t McapWriter::AddSchema(const std::string& name, const std::string& encoding,
                               const std::string& data) {
  std::string schema;
  Append(++schema_count_, schema);
  AppendText(name, schema);
  AppendText(encoding, schema);
  AppendText(data, schema);
  const std::string record = Record(kSchema, schema);
  chunk_ += record;
  schemas_ += record;
  return schema_count_;
}

uint16_t McapWriter::AddChannel(uint16_t schema, const std::string& topic,
                                const std::string& encoding, const Metadata& metadata) {
  std::string pairs;
  for (const auto& [key, value] : metadata) {
    AppendText(key, pairs);
    AppendText(value, pairs);
  }
  std::string channel;
  Append(channel_count_, channel);
  Append(schema, channel);
  AppendText(topic, channel);
  AppendText(encoding, channel);
  AppendText(pairs, channel);
  const std::string record = Record(kChannel, channel);
  chunk_ += record;
  channels_ += record;
  counts_[channel_count_] = 0;
  return channel_count_++;
}

void McapWriter::Write(uint16_t channel, uint64_t time, std::string_view data) {
  index_[channel].push_back({time, chunk_.size()});
  first_time_ = std::min(first_time_, time);
  last_time_ = std::max(last_time_, time);
  chunk_.push_back(static_cast<char>(kMessage));
  Append(uint64_t{sizeof channel + sizeof(uint32_t) + 2 * sizeof time + data.size()}, chunk_);
  Append(channel, chunk_);
  Append(static_cast<uint32_t>(counts_[channel]++), chunk_);
  Append(time, chunk_);  // log time
  Append(time, chunk_);  // publish time
  chunk_.append(data);
  if (chunk_.size() >= chunk_bytes_) EndChunk();
}

void McapWriter::EndChunk() {
  if (chunk_.empty()) return;
  ChunkRecord made;
  if (!index_.empty()) {
    made.first_time = first_time_;
    made.last_time = last_time_;
  }
  made.plain_bytes = chunk_.size();
  const uint32_t crc = Crc32(chunk_);
  const std::string packed =
      compression_.name.empty() ? std::move(chunk_) : compression_.compress(chunk_);
  made.packed_bytes = packed.size();

  std::string head;
  Append(made.first_time, head);
  Append(made.last_time, head);
  Append(made.plain_bytes, head);
  Append(crc, head);
  AppendText(compression_.name, head);
  Append(made.packed_bytes, head);
  made.start = position_;
  Put(std::string(1, static_cast<char>(kChunk)));
  std::string length;
  Append(uint64_t{head.size() + packed.size()}, length);
  Put(length);
  Put(head);
  Put(packed);
  made.length = position_ - made.start;

  const uint64_t indexes = position_;
  for (auto& [channel, entries] : index_) {
    made.index_offsets[channel] = position_;
    std::string index;
    Append(channel, index);
    Append(static_cast<uint32_t>(entries.size() * sizeof(IndexEntry)), index);
    for (const IndexEntry& entry : entries) {
      Append(entry.time, index);
      Append(entry.offset, index);
    }
    Put(Record(kMessageIndex, index));
  }
  made.index_length = position_ - indexes;
  chunks_.push_back(std::move(made));
  chunk_.clear();
  index_.clear();
  first_time_ = UINT64_MAX;
  last_time_ = 0;
}

std::string McapWriter::Statistics() const {
  uint64_t messages = 0, first = UINT64_MAX, last = 0;
  for (const auto& [channel, count] : counts_) messages += count;
  for (const ChunkRecord& chunk : chunks_) {
    if (chunk.index_offsets.empty()) continue;
    first = std::min(first, chunk.first_time);
    last = std::max(last, chunk.last_time);
  }
  std::string content;
  Append(messages, content);
  Append(schema_count_, content);
  Append(uint32_t{channel_count_}, content);
  Append(uint32_t{0}, content);  // number of attachments
  Append(uint32_t{0}, content);  // number of metadata records
  Append(static_cast<uint32_t>(chunks_.size()), content);
  Append(messages > 0 ? first : uint64_t{0}, content);
  Append(last, content);
  return Record(kStatistics, content + MapOf(counts_));
}

void McapWriter::Close() {
  EndChunk();
  std::string crc;
  Append(crc_, crc);
  Put(Record(kDataEnd, crc));

  std::string chunk_indexes;
  for (const ChunkRecord& chunk : chunks_) {
    std::string content;
    Append(chunk.first_time, content);
    Append(chunk.last_time, content);
    Append(chunk.start, content);
    Append(chunk.length, content);
    content += MapOf(chunk.index_offsets);
    Append(chunk.index_length, content);
    AppendText(compression_.name, content);
    Append(chunk.packed_bytes, content);
    Append(chunk.plain_bytes, content);
    chunk_indexes += Record(kChunkIndex, content);
  }
  const uint64_t summary_start = position_;
  std::string summary, offsets;
  const auto add_group = [&](Opcode opcode, const std::string& records) {
    if (records.empty()) return;
    std::string content(1, static_cast<char>(opcode));
    Append(uint64_t{summary_start + summary.size()}, content);
    Append(static_cast<uint64_t>(records.size()), content);
    offsets += Record(kSummaryOffset, content);
    summary += records;
  };
  add_group(kSchema, schemas_);
  add_group(kChannel, channels_);
  add_group(kStatistics, Statistics());
  add_group(kChunkIndex, chunk_indexes);

  std::string footer;
  Append(summary_start, footer);
  Append(uint64_t{summary_start + summary.size()}, footer);
  // The CRC covers everything from the summary up to the CRC itself.
  std::string last = summary + offsets;
  last.push_back(static_cast<char>(kFooter));
  Append(uint64_t{footer.size() + sizeof(uint32_t)}, last);
  last += footer;
  Append(Crc32(last), last);
  last += kMagic;
  Put(last);
}

}  // namespace alidade
