#include "alidade/io/ros/containers/ros1_bag.h"

#include <algorithm>
#include <map>

#include "alidade/base/error.h"
#include "alidade/io/ros/containers/byte_cursor.h"
#include "alidade/io/ros/containers/chunk_cache.h"
#include "alidade/io/ros/containers/indexed_bag.h"
#include "alidade/io/ros/containers/ros1_record.h"
#include "alidade/io/ros/containers/unpack.h"

namespace alidade {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";

class Ros1Bag : public IndexedBag {
 public:
  explicit Ros1Bag(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {
    FillByIndexOr([this] { ReadIndex(); }, [this] { connections_.clear(); }, [this] { Scan(); });
  }

  std::string Read(const BagMessage& message, std::string& bytes, uint64_t most) override try {
    if (message.offset == kUnpacked) {
      const Ros1Record record = ReadRos1Record(*source_, message.place);
      bytes = source_->Read(record.data_at, std::min<uint64_t>(record.data_size, most));
      return {};
    }
    const std::string& chunk =
        chunks_.Get(message.place, [&] { return UnpackedChunk(ReadChunk(message.place)); });
    uint64_t at = message.offset;
    const Ros1Item item = TakeRos1Item(chunk, at);
    if (item.fields.Op() != Ros1Op::kMessage) ThrowInput("is damaged: its index is wrong");
    bytes = item.data.substr(0, most);
    return {};
  } catch (const Error& error) {
    return error.what();
  }

 private:
  Ros1Record ReadChunk(uint64_t at) const {
    Ros1Record record = ReadRos1Record(*source_, at);
    if (record.fields.Op() != Ros1Op::kChunk) ThrowInput("is damaged: its index is wrong");
    return record;
  }

  std::string UnpackedChunk(const Ros1Record& chunk) const {
    if (chunk.data_size > kMostUnpacked) ThrowInput("is damaged: a chunk is too long");
    return Unpack(chunk.fields.Text("compression"), source_->Read(chunk.data_at, chunk.data_size),
                  MostUnpackedFrom(chunk.data_size));
  }

  void AddConnection(const Ros1Fields& fields, std::string_view data) {
    const Ros1Fields header{std::string(data)};
    connections_[fields.Number<uint32_t>("conn")] =
        TopicOf(fields.Text("topic"), header.Text("type"), Serialization::kRos1);
  }

  size_t TopicOfConnection(const Ros1Fields& fields) const {
    const auto found = connections_.find(fields.Number<uint32_t>("conn"));
    if (found == connections_.end()) ThrowInput("is damaged: a message of an unknown topic");
    return found->second;
  }

  // Indexes the messages by the records at the end of the file and the index after each chunk.
  void ReadIndex() {
    const Ros1Record head = ReadRos1Record(*source_, kMagic.size());
    if (head.fields.Op() != Ros1Op::kBagHeader) ThrowInput("is damaged: its header is missing");
    auto at = head.fields.Number<uint64_t>("index_pos");
    if (at == 0) ThrowInput("was never closed");
    std::vector<Ros1Fields> chunks;
    while (at < source_->Size()) {
      const Ros1Record record = ReadRos1Record(*source_, at);
      if (record.fields.Op() == Ros1Op::kConnection) {
        AddConnection(record.fields, source_->Read(record.data_at, record.data_size));
      } else if (record.fields.Op() == Ros1Op::kChunkInfo) {
        chunks.push_back(record.fields);
      }
      at = record.End();
    }
    if (at != source_->Size() || chunks.size() != head.fields.Number<uint32_t>("chunk_count"))
      ThrowInput("is truncated");
    uint64_t last_end = 0;  // reject overlapping chunks, so that no message is counted twice
    for (const Ros1Fields& chunk : chunks) {
      const auto place = chunk.Number<uint64_t>("chunk_pos");
      if (place < last_end) ThrowInput("is damaged: its chunks overlap");
      last_end = ReadIndexOfChunk(place, chunk.Number<uint32_t>("count"));
    }
  }

  uint64_t ReadIndexOfChunk(uint64_t place, uint32_t connections) {
    uint64_t at = ReadChunk(place).End();
    for (uint32_t i = 0; i < connections; ++i) {
      const Ros1Record record = ReadRos1Record(*source_, at);
      if (record.fields.Op() != Ros1Op::kIndexData) ThrowInput("is damaged: its index is wrong");
      const size_t topic = TopicOfConnection(record.fields);
      const auto count = record.fields.Number<uint32_t>("count");
      if (uint64_t{count} * 12 != record.data_size) ThrowInput("is damaged: its index is wrong");
      if (IsWanted(topic)) {
        const std::string data = source_->Read(record.data_at, record.data_size);
        for (ByteCursor cursor(data); !cursor.AtEnd();) {
          const int64_t time = Ros1Time(cursor.Number<uint64_t>());
          Add(topic, {time, place, cursor.Number<uint32_t>(), 0});
        }
      } else {
        Count(topic, count);
      }
      at = record.End();
    }
    return at;
  }

  // Reads record by record. The records of uncompressed chunks are read directly from the file, so
  // that a chunk that is truncated, or whose length was never written, is read as far as possible.
  void Scan() {
    uint64_t at = kMagic.size();
    uint64_t chunk_end = 0;
    while (at < source_->Size()) {
      try {
        const Ros1Record record = ReadRos1Record(*source_, at);
        const Ros1Op op = record.fields.Op();
        if (op == Ros1Op::kChunk && record.fields.Text("compression") == "none") {
          chunk_end = record.End();
          at = record.data_at;
          continue;
        }
        if (record.End() > source_->Size()) ThrowInput("is truncated");
        if (op == Ros1Op::kConnection) {
          AddConnection(record.fields, source_->Read(record.data_at, record.data_size));
        } else if (op == Ros1Op::kMessage) {
          Add(TopicOfConnection(record.fields), {record.fields.Time(), at, kUnpacked, 0});
        } else if (op == Ros1Op::kChunk) {
          ScanChunk(record, at);
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
          break;
        }
      }
    }
  }

  // When a chunk cannot be unpacked, its messages are skipped.
  void ScanChunk(const Ros1Record& record, uint64_t place) try {
    const std::string chunk = UnpackedChunk(record);
    for (uint64_t at = 0; at < chunk.size();) {
      const uint64_t offset = at;
      const Ros1Item item = TakeRos1Item(chunk, at);
      if (item.fields.Op() == Ros1Op::kConnection) {
        AddConnection(item.fields, item.data);
      } else if (item.fields.Op() == Ros1Op::kMessage) {
        Add(TopicOfConnection(item.fields),
            {item.fields.Time(), place, static_cast<uint32_t>(offset), 0});
      }
    }
  } catch (const Error& error) {
    Warn("a chunk at byte " + std::to_string(place) + " " + error.what() + "; it is ignored");
  }

  std::unique_ptr<ByteSource> source_;
  std::map<uint32_t, size_t> connections_;  // connection id -> index of the topic
  ChunkCache chunks_;
};

}  // namespace

bool LooksLikeRos1Bag(std::string_view start) { return start.substr(0, 9) == "#ROSBAG V"; }

std::unique_ptr<BagFile> OpenRos1Bag(std::unique_ptr<ByteSource> source) {
  const std::string start = source->Read(0, std::min<uint64_t>(source->Size(), kMagic.size()));
  if (start != kMagic) {
    ThrowInput(LooksLikeRos1Bag(start)
                   ? "is a ROS bag of another version than 2.0: `rosbag migrate` converts it"
                   : "is not a ROS bag");
  }
  return std::make_unique<Ros1Bag>(std::move(source));
}

}  // namespace alidade
