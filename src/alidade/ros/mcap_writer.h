// Writes messages to an MCAP file (version 0 of the format): chunks with checksums and indexes, and
// a summary at the end. If the program is killed, readers can recover the chunks written so far;
// Close() completes the file.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace alidade {

// Compression of a chunk's records. Empty name: none.
struct McapCompression {
  std::string name;  // "zstd" or "lz4"
  std::function<std::string(std::string_view)> compress;
};

class McapWriter {
 public:
  using Sink = std::function<void(std::string_view)>;  // receives the file's bytes in order
  using Metadata = std::vector<std::pair<std::string, std::string>>;
  // Uncompressed size of a chunk, bytes. It is what is lost when the program is killed, and what a
  // reader must unpack to get one message. Foxglove's tools and rosbag2 use 0.75 to 4 MB.
  static constexpr size_t kChunkBytes = size_t{1} << 20;

  McapWriter(Sink sink, const std::string& profile, const std::string& library,
             McapCompression compression = {}, size_t chunk_bytes = kChunkBytes);
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  uint16_t AddSchema(const std::string& name, const std::string& encoding, const std::string& data);
  uint16_t AddChannel(uint16_t schema, const std::string& topic, const std::string& encoding,
                      const Metadata& metadata);
  // `time`: nanoseconds. The messages of a channel are numbered from 0.
  void Write(uint16_t channel, uint64_t time, std::string_view data);
  void Close();  // must be the last call

 private:
  struct IndexEntry {
    uint64_t time = 0, offset = 0;  // within the chunk
  };
  struct ChunkRecord {
    uint64_t first_time = 0, last_time = 0, start = 0, length = 0;
    std::map<uint16_t, uint64_t> index_offsets;
    uint64_t index_length = 0, packed_bytes = 0, plain_bytes = 0;
  };
  void Put(std::string_view bytes);
  void EndChunk();
  std::string Statistics() const;

  Sink sink_;
  McapCompression compression_;
  size_t chunk_bytes_;
  uint64_t position_ = 0;  // bytes written so far
  uint32_t crc_ = 0;       // CRC of the bytes written so far

  std::string chunk_;  // records of the current chunk
  std::map<uint16_t, std::vector<IndexEntry>> index_;
  uint64_t first_time_ = UINT64_MAX, last_time_ = 0;  // of the current chunk, nanoseconds

  std::vector<ChunkRecord> chunks_;
  std::string schemas_, channels_;  // encoded records, for the summary
  uint16_t schema_count_ = 0, channel_count_ = 0;
  std::map<uint16_t, uint64_t> counts_;  // number of messages per channel
};

}  // namespace alidade
