// Writers of message containers: ROS bag 2.0, MCAP, rosbag2's database. Implemented from the
// formats' specifications, independently of the readers.
#pragma once

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace alidade {

struct WrittenMessage {
  std::string topic, type;  // "sensor_msgs/Image"
  int64_t log_time = 0;     // nanoseconds
  std::string bytes;
};

inline std::string Packed(const std::string& format, const std::string& bytes) {
  if (format == "bz2") {
    auto size = static_cast<unsigned>(bytes.size() + bytes.size() / 50 + 700);
    std::string packed(size, '\0');
    BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(bytes.data()),
                             static_cast<unsigned>(bytes.size()), 1, 0, 0);
    return packed.substr(0, size);
  }
  if (format == "lz4") {
    std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
    return packed.substr(
        0, LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  }
  if (format == "zstd") {
    std::string packed(ZSTD_compressBound(bytes.size()), '\0');
    return packed.substr(
        0, ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
  }
  return bytes;
}

template <typename T>
std::string Little(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}
inline std::string Sized32(const std::string& bytes) {
  return Little(static_cast<uint32_t>(bytes.size())) + bytes;
}

struct BagForm {
  std::string packing;  // none, bz2, lz4, zstd
  bool closed = true;   // with the index that a recorder writes at the end
  bool chunks = true;   // MCAP only
  size_t chunk_messages = 4;
  bool padded = true;  // bag only: its first record takes 4 KB
};

class BagBytes {
 public:
  explicit BagBytes(const BagForm& form) : form_(form) {}

  std::string Of(const std::vector<WrittenMessage>& messages) {
    std::string file = "#ROSBAG V2.0\n";
    const size_t head_at = file.size();
    file += Head(0, 0);
    std::string infos;
    uint32_t chunks = 0;
    for (size_t i = 0; i < messages.size(); i += form_.chunk_messages) {
      ++chunks;
      AddChunk(messages, i, file, infos);
    }
    if (!form_.closed) return file;
    const uint64_t index_at = file.size();
    for (const auto& [topic, connection] : connections_) file += connection.record;
    file += infos;
    return file.replace(head_at, Head(0, 0).size(), Head(index_at, chunks));
  }

 private:
  struct Connection {
    uint32_t id;
    std::string record;
  };
  static std::string Field(const std::string& name, const std::string& value) {
    return Sized32(name + "=" + value);
  }
  static std::string Record(char op, const std::string& fields, const std::string& data) {
    return Sized32(fields + Field("op", std::string(1, op))) + Sized32(data);
  }
  std::string Head(uint64_t index_at, uint32_t chunks) const {
    const std::string fields =
        Field("index_pos", Little(index_at)) +
        Field("conn_count", Little(static_cast<uint32_t>(connections_.size()))) +
        Field("chunk_count", Little(chunks));
    return Record(3, fields, std::string(form_.padded ? 4027 - fields.size() : 0, ' '));
  }
  static std::string Time(int64_t ns) {
    return Little(static_cast<uint32_t>(ns / 1'000'000'000)) +
           Little(static_cast<uint32_t>(ns % 1'000'000'000));
  }

  void AddChunk(const std::vector<WrittenMessage>& messages, size_t first, std::string& file,
                std::string& infos) {
    std::string plain;
    std::map<uint32_t, std::string> indexes;
    for (size_t i = first; i < std::min(first + form_.chunk_messages, messages.size()); ++i) {
      const WrittenMessage& message = messages[i];
      const auto [found, is_new] = connections_.try_emplace(message.topic);
      Connection& connection = found->second;
      if (is_new) {
        connection.id = static_cast<uint32_t>(connections_.size() - 1);
        connection.record =
            Record(7, Field("conn", Little(connection.id)) + Field("topic", message.topic),
                   Field("topic", message.topic) + Field("type", message.type) +
                       Field("md5sum", "*") + Field("message_definition", "..."));
        plain += connection.record;
      }
      indexes[connection.id] +=
          Time(message.log_time) + Little(static_cast<uint32_t>(plain.size()));
      plain +=
          Record(2, Field("conn", Little(connection.id)) + Field("time", Time(message.log_time)),
                 message.bytes);
    }
    const uint64_t place = file.size();
    file += Record(5,
                   Field("compression", form_.packing) +
                       Field("size", Little(static_cast<uint32_t>(plain.size()))),
                   Packed(form_.packing, plain));
    std::string counts;
    for (const auto& [id, entries] : indexes) {
      const auto count = static_cast<uint32_t>(entries.size() / 12);
      counts += Little(id) + Little(count);
      file += Record(4,
                     Field("ver", Little(uint32_t{1})) + Field("conn", Little(id)) +
                         Field("count", Little(count)),
                     entries);
    }
    infos += Record(6,
                    Field("ver", Little(uint32_t{1})) + Field("chunk_pos", Little(place)) +
                        Field("start_time", Time(messages[first].log_time)) +
                        Field("end_time", Time(messages[first].log_time)) +
                        Field("count", Little(static_cast<uint32_t>(indexes.size()))),
                    counts);
  }

  BagForm form_;
  std::map<std::string, Connection> connections_;
};

// The ROS 2 spelling of "sensor_msgs/Image".
inline std::string Ros2Type(const std::string& type) {
  return type.substr(0, type.find('/')) + "/msg/" + type.substr(type.find('/') + 1);
}

class McapBytes {
 public:
  McapBytes(const BagForm& form, bool ros1) : form_(form), ros1_(ros1) {}

  std::string Of(const std::vector<WrittenMessage>& messages) {
    const std::string magic = "\x89MCAP0\r\n";
    std::string file = magic + Record(1, Sized32(ros1_ ? "ros1" : "ros2") + Sized32("test"));
    std::string indexes;
    const size_t step = form_.chunks ? form_.chunk_messages : messages.size();
    for (size_t first = 0; first < messages.size(); first += step) {
      std::string plain;
      std::map<uint16_t, std::string> entries;
      for (size_t i = first; i < std::min(first + step, messages.size()); ++i)
        Add(messages[i], plain, entries);
      if (form_.chunks) {
        AddChunk(plain, messages[first].log_time, entries, file, indexes);
      } else {
        file += plain;
      }
    }
    if (!form_.closed) return file;
    file += Record(15, Little(uint32_t{0}));
    const uint64_t summary_at = file.size();
    std::string summary;
    for (const auto& [topic, channel] : channels_) summary += channel.records;
    summary += indexes;
    std::string footer = Little(summary_at) + Little(uint64_t{0});
    const std::string crc_of = summary + std::string(1, 2) + Little(uint64_t{20}) + footer;
    footer += Little(Crc(crc_of));
    return file + summary + Record(2, footer) + magic;
  }

 private:
  struct Channel {
    uint16_t id;
    std::string records;
  };
  static uint32_t Crc(const std::string& bytes) {
    return static_cast<uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
  }
  static std::string Record(char op, const std::string& content) {
    return std::string(1, op) + Little(static_cast<uint64_t>(content.size())) + content;
  }

  void Add(const WrittenMessage& message, std::string& plain,
           std::map<uint16_t, std::string>& entries) {
    const auto [found, is_new] = channels_.try_emplace(message.topic);
    Channel& channel = found->second;
    if (is_new) {
      channel.id = static_cast<uint16_t>(channels_.size());
      // Types of Protocol Buffers have a point: "foxglove.CompressedVideo".
      const bool protobuf = message.type.find('.') != std::string::npos;
      const std::string type = ros1_ || protobuf ? message.type : Ros2Type(message.type);
      const std::string schema = protobuf ? "protobuf" : ros1_ ? "ros1msg" : "ros2msg";
      const std::string encoding = protobuf ? "protobuf" : ros1_ ? "ros1" : "cdr";
      channel.records =
          Record(3, Little(channel.id) + Sized32(type) + Sized32(schema) + Sized32("...")) +
          Record(4, Little(channel.id) + Little(channel.id) + Sized32(message.topic) +
                        Sized32(encoding) + Sized32(""));
      plain += channel.records;
    }
    const auto time = static_cast<uint64_t>(message.log_time);
    entries[channel.id] += Little(time) + Little(static_cast<uint64_t>(plain.size()));
    plain += Record(
        5, Little(channel.id) + Little(uint32_t{0}) + Little(time) + Little(time) + message.bytes);
  }

  void AddChunk(const std::string& plain, int64_t start,
                const std::map<uint16_t, std::string>& entries, std::string& file,
                std::string& indexes) {
    const std::string packing = form_.packing == "none" ? "" : form_.packing;
    const std::string packed = Packed(packing, plain);
    const auto time = static_cast<uint64_t>(start);
    const std::string chunk =
        Record(6, Little(time) + Little(time) + Little(static_cast<uint64_t>(plain.size())) +
                      Little(Crc(plain)) + Sized32(packing) +
                      Little(static_cast<uint64_t>(packed.size())) + packed);
    const uint64_t chunk_at = file.size();
    file += chunk;
    std::string index, offsets;
    for (const auto& [id, list] : entries) {
      offsets += Little(id) + Little(static_cast<uint64_t>(file.size() + index.size()));
      index += Record(7, Little(id) + Sized32(list));
    }
    file += index;
    indexes += Record(8, Little(time) + Little(time) + Little(chunk_at) +
                             Little(static_cast<uint64_t>(chunk.size())) + Sized32(offsets) +
                             Little(static_cast<uint64_t>(index.size())) + Sized32(packing) +
                             Little(static_cast<uint64_t>(packed.size())) +
                             Little(static_cast<uint64_t>(plain.size())));
  }

  BagForm form_;
  bool ros1_;
  std::map<std::string, Channel> channels_;
};

// With `packing` zstd every message is compressed separately.
inline void WriteDatabase(const std::string& path, const std::vector<WrittenMessage>& messages,
                          const std::string& packing = "") {
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  const auto run = [&](const std::string& sql, const std::string& blob = "") {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr);
    if (!blob.empty())
      sqlite3_bind_blob(statement, 1, blob.data(), static_cast<int>(blob.size()), SQLITE_TRANSIENT);
    sqlite3_step(statement);
    sqlite3_finalize(statement);
  };
  run("PRAGMA page_size=512");
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER "
      "NOT NULL, data BLOB NOT NULL)");
  run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  run("BEGIN");
  std::map<std::string, size_t> topics;
  for (const WrittenMessage& message : messages) {
    const auto [found, is_new] = topics.try_emplace(message.topic, topics.size() + 1);
    const std::string id = std::to_string(found->second);
    if (is_new)
      run("INSERT INTO topics VALUES (" + id + ", '" + message.topic + "', '" +
          Ros2Type(message.type) + "', 'cdr', '')");
    run("INSERT INTO messages(topic_id, timestamp, data) VALUES (" + id + ", " +
            std::to_string(message.log_time) + ", ?1)",
        Packed(packing, message.bytes));
  }
  run("COMMIT");
  sqlite3_close(database);
}

}  // namespace alidade
