#include "alidade/io/ros/containers/mcap_bag.h"

#include <zlib.h>

#include <algorithm>
#include <map>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/io/ros/containers/chunk_cache.h"
#include "alidade/io/ros/containers/indexed_bag.h"
#include "alidade/io/ros/containers/mcap_record.h"
#include "alidade/io/ros/containers/unpack.h"

namespace alidade {
namespace {

uint32_t CrcOf(std::string_view bytes) {
  return static_cast<uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

class McapFile : public IndexedBag {
 public:
  explicit McapFile(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {
    FillByIndexOr([this] { ReadSummary(); }, [this] { schemas_.clear(), channels_.clear(); },
                  [this] { Scan(); });
  }

  std::string Read(const BagMessage& message, std::string& bytes, uint64_t most) override try {
    if (message.offset == kUnpacked) {
      const McapRecord record = ReadMcapRecord(*source_, message.place);
      const uint64_t size = most < record.size ? kMcapMessageHead + most : record.size;
      const std::string content = source_->Read(record.content_at, std::min(size, record.size));
      bytes = ParseMcapMessage(content).data;
      return {};
    }
    const std::string& chunk = chunks_.Get(
        message.place, [&] { return UnpackedChunk(ReadMcapRecord(*source_, message.place)); });
    if (message.offset > chunk.size()) ThrowInput("is damaged: its index is wrong");
    ByteCursor cursor(std::string_view(chunk).substr(message.offset));
    const McapItem item = TakeMcapItem(cursor);
    if (item.op != McapOp::kMessage) ThrowInput("is damaged: its index is wrong");
    bytes = ParseMcapMessage(item.content).data.substr(0, most);
    return {};
  } catch (const Error& error) {
    return error.what();
  }

 private:
  std::string UnpackedChunk(const McapRecord& record) const {
    if (record.op != McapOp::kChunk) ThrowInput("is damaged: its index is wrong");
    const McapChunkHead head = ReadMcapChunkHead(*source_, record);
    if (head.unpacked_size > kMostUnpacked || head.records_size > kMostUnpacked)
      ThrowInput("is damaged, or has a chunk of over " + std::to_string(kMostUnpacked >> 20) +
                 " MB");
    std::string chunk = Unpack(head.compression, source_->Read(head.records_at, head.records_size),
                               MostUnpackedFrom(head.records_size));
    if (chunk.size() != head.unpacked_size) ThrowInput("is damaged: a chunk has the wrong length");
    if (head.crc != 0 && CrcOf(chunk) != head.crc)
      ThrowInput("is damaged: a chunk's checksum does not fit");
    return chunk;
  }

  void AddSchema(std::string_view content) {
    const McapSchema schema = ParseMcapSchema(content);
    schemas_[schema.id] = schema.name;
  }

  void AddChannel(std::string_view content) {
    const McapChannel channel = ParseMcapChannel(content);
    const Serialization serialization = channel.encoding == "cdr"        ? Serialization::kCdr
                                        : channel.encoding == "ros1"     ? Serialization::kRos1
                                        : channel.encoding == "protobuf" ? Serialization::kProtobuf
                                                                         : Serialization::kOther;
    const auto schema = schemas_.find(channel.schema);
    channels_[channel.id] = TopicOf(
        channel.topic, schema == schemas_.end() ? "(no type)" : schema->second, serialization);
  }

  size_t TopicOfChannel(uint16_t channel) const {
    const auto found = channels_.find(channel);
    if (found == channels_.end()) ThrowInput("is damaged: a message of an unknown channel");
    return found->second;
  }

  // Indexes the messages by the summary at the end of the file and the message indexes after each
  // chunk.
  void ReadSummary() {
    constexpr uint64_t kFooter = 20;
    const uint64_t size = source_->Size(), end = kMcapRecordHead + kFooter + kMcapMagic.size();
    if (size < kMcapMagic.size() + end ||
        source_->Read(size - kMcapMagic.size(), kMcapMagic.size()) != kMcapMagic)
      ThrowInput("is truncated, or was never closed");
    const uint64_t footer_at = size - end;
    const McapRecord footer = ReadMcapRecord(*source_, footer_at);
    if (footer.op != McapOp::kFooter || footer.size != kFooter)
      ThrowInput("is damaged: its footer is missing");
    const std::string footer_bytes = source_->Read(footer_at, kMcapRecordHead + kFooter);
    ByteCursor cursor(std::string_view(footer_bytes).substr(kMcapRecordHead));
    const auto start = cursor.Number<uint64_t>();
    cursor.Number<uint64_t>();  // offset of the summary offset section
    const auto crc = cursor.Number<uint32_t>();
    if (start == 0) ThrowInput("has no summary");
    if (start > footer_at) ThrowInput("is damaged: its footer is wrong");
    const std::string summary = source_->Read(start, footer_at - start);
    // The checksum covers the summary and the footer up to the checksum itself.
    if (crc != 0 &&
        CrcOf(summary + footer_bytes.substr(0, footer_bytes.size() - sizeof(crc))) != crc)
      ThrowInput("is damaged: its summary's checksum does not fit");
    ReadIndexes(summary);
  }

  void ReadIndexes(const std::string& summary) {
    std::vector<McapChunkIndex> chunks;
    std::optional<uint64_t> messages;
    for (ByteCursor cursor(summary); !cursor.AtEnd();) {
      const McapItem item = TakeMcapItem(cursor);
      if (item.op == McapOp::kSchema) AddSchema(item.content);
      if (item.op == McapOp::kChannel) AddChannel(item.content);
      if (item.op == McapOp::kChunkIndex) chunks.push_back(ParseMcapChunkIndex(item.content));
      if (item.op == McapOp::kStatistics) messages = ByteCursor(item.content).Number<uint64_t>();
    }
    if (chunks.empty()) ThrowInput("has no chunks with indexes");
    std::sort(chunks.begin(), chunks.end(), [](const McapChunkIndex& a, const McapChunkIndex& b) {
      return a.chunk_at < b.chunk_at;
    });
    uint64_t last_end = 0;  // reject overlapping chunks, so that no message is counted twice
    for (const McapChunkIndex& chunk : chunks) {
      const uint64_t size = source_->Size();
      if (chunk.chunk_at < last_end || chunk.chunk_size > size || chunk.index_size > size)
        ThrowInput("is damaged: its chunks overlap");
      last_end = chunk.chunk_at + chunk.chunk_size + chunk.index_size;
      if (chunk.index_size == 0) ThrowInput("has chunks without indexes");
      ReadIndexesOfChunk(chunk);
    }
    int64_t found = 0;
    for (const BagTopic& topic : Topics()) found += topic.messages;
    if (messages && *messages != static_cast<uint64_t>(found))
      ThrowInput("has messages outside of its indexes");
  }

  void ReadIndexesOfChunk(const McapChunkIndex& chunk) {
    const std::string bytes = source_->Read(chunk.chunk_at + chunk.chunk_size, chunk.index_size);
    for (ByteCursor cursor(bytes); !cursor.AtEnd();) {
      const McapItem item = TakeMcapItem(cursor);
      if (item.op != McapOp::kMessageIndex) ThrowInput("is damaged: its index is wrong");
      const McapMessageIndex index = ParseMcapMessageIndex(item.content);
      if (index.entries.empty()) continue;
      const size_t topic = TopicOfChannel(index.channel);
      for (const McapIndexEntry& entry : index.entries) {
        if (entry.offset >= kUnpacked) ThrowInput("is damaged: its index is wrong");
        Add(topic, {entry.log_time, chunk.chunk_at, static_cast<uint32_t>(entry.offset), 0});
      }
    }
  }

  // Reads record by record. The records of uncompressed chunks are read directly from the file, so
  // that a truncated chunk is read as far as possible.
  void Scan() {
    uint64_t at = kMcapMagic.size();
    uint64_t chunk_end = 0;
    while (at < source_->Size()) {
      try {
        const McapRecord record = ReadMcapRecord(*source_, at);
        if (record.op == McapOp::kDataEnd || record.op == McapOp::kFooter) return;
        if (record.op == McapOp::kChunk) {
          const McapChunkHead head = ReadMcapChunkHead(*source_, record);
          if (head.compression.empty()) {
            chunk_end = record.End();
            at = head.records_at;
            continue;
          }
        }
        if (record.End() > source_->Size()) ThrowInput("is truncated");
        if (record.op == McapOp::kChunk) {
          ScanChunk(record, at);
        } else if (record.op == McapOp::kMessage) {
          const std::string head =
              source_->Read(record.content_at, std::min(record.size, kMcapMessageHead));
          const McapMessage message = ParseMcapMessage(head);
          Add(TopicOfChannel(message.channel), {message.log_time, at, kUnpacked, 0});
        } else if (record.op == McapOp::kSchema) {
          AddSchema(source_->Read(record.content_at, record.size));
        } else if (record.op == McapOp::kChannel) {
          AddChannel(source_->Read(record.content_at, record.size));
        }
        at = record.End();
      } catch (const Error& error) {
        const std::string where =
            ", at byte " + std::to_string(at) + " of " + std::to_string(source_->Size());
        if (at < chunk_end && chunk_end < source_->Size()) {
          Warn(std::string(error.what()) + where + "; the rest of this chunk is ignored");
          at = chunk_end;
        } else {
          Warn(std::string(error.what()) + where + "; the rest of the file is ignored");
          return;
        }
      }
    }
    Warn("ends without a footer: it was never closed, or is truncated");
  }

  // When a chunk cannot be unpacked, its messages are skipped.
  void ScanChunk(const McapRecord& record, uint64_t place) try {
    const std::string chunk = UnpackedChunk(record);
    for (ByteCursor cursor(chunk); !cursor.AtEnd();) {
      const size_t offset = chunk.size() - cursor.Left();
      const McapItem item = TakeMcapItem(cursor);
      if (item.op == McapOp::kSchema) AddSchema(item.content);
      if (item.op == McapOp::kChannel) AddChannel(item.content);
      if (item.op != McapOp::kMessage) continue;
      const McapMessage message = ParseMcapMessage(item.content);
      Add(TopicOfChannel(message.channel),
          {message.log_time, place, static_cast<uint32_t>(offset), 0});
    }
  } catch (const Error& error) {
    Warn("a chunk at byte " + std::to_string(place) + " " + error.what() + "; it is ignored");
  }

  std::unique_ptr<ByteSource> source_;
  std::map<uint16_t, std::string> schemas_;
  std::map<uint16_t, size_t> channels_;  // channel id -> index of the topic
  ChunkCache chunks_;
};

}  // namespace

bool LooksLikeMcap(std::string_view start) {
  return start.substr(0, kMcapMagic.size()) == kMcapMagic;
}

std::unique_ptr<BagFile> OpenMcapFile(std::unique_ptr<ByteSource> source) {
  const uint64_t size = std::min<uint64_t>(source->Size(), kMcapMagic.size());
  if (!LooksLikeMcap(source->Read(0, size))) ThrowInput("is not an MCAP file");
  return std::make_unique<McapFile>(std::move(source));
}

}  // namespace alidade
