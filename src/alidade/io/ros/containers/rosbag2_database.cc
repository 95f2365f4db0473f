#include "alidade/io/ros/containers/rosbag2_database.h"

#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <map>
#include <new>

#include "alidade/base/error.h"
#include "alidade/io/ros/containers/indexed_bag.h"
#include "alidade/io/ros/containers/unpack.h"

namespace alidade {
namespace {

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

// The file's name as a URI; all bytes except letters, digits and `/._-` are percent-encoded.
std::string UriOf(const std::string& path) {
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string uri = "file:";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z') ||
        (byte >= '0' && byte <= '9') || byte == '/' || byte == '.' || byte == '_' || byte == '-') {
      uri += c;
    } else {
      uri += '%';
      uri += kHex[byte >> 4];
      uri += kHex[byte & 15];
    }
  }
  return uri;
}

Database Open(const std::string& uri) {
  sqlite3* opened = nullptr;
  const int result =
      sqlite3_open_v2(uri.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  Database database(opened, sqlite3_close);
  if (!database) throw std::bad_alloc();
  if (result != SQLITE_OK) ThrowInput(std::string("cannot be read: ") + sqlite3_errmsg(opened));
  // The file is untrusted: limit the size of values, and disable writing to the schema and
  // functions with side effects.
  sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(kMostUnpacked));
  sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_exec(opened, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
  return database;
}

class Rosbag2Database : public IndexedBag {
 public:
  explicit Rosbag2Database(Database database) : database_(std::move(database)) {
    CheckTables();
    ReadTopics();
    IndexMessages();
    SortByTime();
  }

  std::string Read(const BagMessage& message, std::string& bytes, uint64_t most) override try {
    sqlite3_blob* opened = nullptr;
    const int result = sqlite3_blob_open(database_.get(), "main", "messages", "data",
                                         static_cast<sqlite3_int64>(message.place), 0, &opened);
    const std::unique_ptr<sqlite3_blob, int (*)(sqlite3_blob*)> blob(opened, sqlite3_blob_close);
    if (result != SQLITE_OK) ThrowInput(Complaint());
    const int size = sqlite3_blob_bytes(blob.get());
    const auto read = [&](uint64_t count) {
      bytes.resize(std::min<uint64_t>(static_cast<uint64_t>(size), count));
      if (sqlite3_blob_read(blob.get(), bytes.data(), static_cast<int>(bytes.size()), 0) !=
          SQLITE_OK)
        ThrowInput(Complaint());
    };
    read(most);
    if (LooksLikeZstd(bytes) && bytes.size() < static_cast<size_t>(size)) read(kWholeMessage);
    // unambiguous, because a CDR message begins with a zero byte
    if (LooksLikeZstd(bytes)) bytes = Unpack("zstd", bytes, MostUnpackedFrom(bytes.size()));
    return {};
  } catch (const Error& error) {
    return error.what();
  }

 private:
  std::string Complaint() const {
    return std::string("is damaged: ") + sqlite3_errmsg(database_.get());
  }

  Statement Prepare(const char* sql) const {
    sqlite3_stmt* prepared = nullptr;
    const int result = sqlite3_prepare_v2(database_.get(), sql, -1, &prepared, nullptr);
    Statement statement(prepared, sqlite3_finalize);
    if (result != SQLITE_OK) ThrowInput(Complaint());
    return statement;
  }

  static std::string Text(const Statement& statement, int column) {
    const unsigned char* text = sqlite3_column_text(statement.get(), column);
    return text == nullptr ? "" : reinterpret_cast<const char*>(text);
  }

  // Rejects views and virtual tables with these names, because their queries could run for ever.
  void CheckTables() const {
    const Statement tables = Prepare(
        "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', "
        "'messages') AND sql NOT LIKE '%VIRTUAL%'");
    if (sqlite3_step(tables.get()) != SQLITE_ROW) ThrowInput(Complaint());
    if (sqlite3_column_int(tables.get(), 0) != 2)
      ThrowInput("is a database, but not of rosbag2: tables `topics` and `messages` are missing");
  }

  void ReadTopics() {
    const Statement topics = Prepare("SELECT id, name, type, serialization_format FROM topics");
    int result = SQLITE_ROW;
    while ((result = sqlite3_step(topics.get())) == SQLITE_ROW) {
      const std::string format = Text(topics, 3);
      topics_of_[sqlite3_column_int64(topics.get(), 0)] =
          TopicOf(Text(topics, 1), Text(topics, 2),
                  format == "cdr" ? Serialization::kCdr : Serialization::kOther);
    }
    if (result != SQLITE_DONE) ThrowInput(Complaint());
  }

  // Reads the messages in order of id. After a damaged page it continues at ids increasingly far
  // (1, 2, 4, …) behind the last message read.
  void IndexMessages() {
    const Statement messages =
        Prepare("SELECT id, topic_id, timestamp FROM messages WHERE id > ?1 ORDER BY id");
    constexpr sqlite3_int64 kLeast = std::numeric_limits<sqlite3_int64>::min(),
                            kMost = std::numeric_limits<sqlite3_int64>::max();
    constexpr sqlite3_int64 kMostStep = sqlite3_int64{1} << 24;
    sqlite3_int64 last = kLeast, step = 1;
    while (true) {
      sqlite3_bind_int64(messages.get(), 1, last);
      int result = SQLITE_ROW;
      while ((result = sqlite3_step(messages.get())) == SQLITE_ROW) {
        const sqlite3_int64 id = sqlite3_column_int64(messages.get(), 0);
        if (id <= last) break;  // a damaged b-tree may contain cycles
        last = id;
        step = 1;
        const auto topic = topics_of_.find(sqlite3_column_int64(messages.get(), 1));
        if (topic == topics_of_.end()) continue;
        Add(topic->second,
            {sqlite3_column_int64(messages.get(), 2), static_cast<uint64_t>(id), 0, 0});
      }
      if (result == SQLITE_DONE) return;
      if (step == 1) {
        Warn((result == SQLITE_ROW ? std::string("is damaged: its messages are out of order")
                                   : Complaint()) +
             "; the readable part is used");
      }
      sqlite3_reset(messages.get());
      if (step > kMostStep || last > kMost - step) return;
      last = last < 0 ? step : last + step;
      step *= 2;
    }
  }

  Database database_;
  std::map<sqlite3_int64, size_t> topics_of_;
};

}  // namespace

bool LooksLikeDatabase(std::string_view start) { return start.substr(0, 15) == "SQLite format 3"; }

std::unique_ptr<BagFile> OpenRosbag2Database(const std::string& path) {
  // A write-ahead log left by a recorder must be read. Without one the file is opened as immutable,
  // so that SQLite creates no files beside it.
  const bool journal = ::access((path + "-wal").c_str(), F_OK) == 0;
  return std::make_unique<Rosbag2Database>(Open(UriOf(path) + (journal ? "" : "?immutable=1")));
}

std::unique_ptr<BagFile> OpenRosbag2DatabaseOf(std::string bytes) {
  Database database = Open(":memory:");
  const auto size = static_cast<sqlite3_int64>(bytes.size());
  auto* copy = static_cast<unsigned char*>(sqlite3_malloc64(bytes.size() + 1));
  if (copy == nullptr) throw std::bad_alloc();
  std::copy(bytes.begin(), bytes.end(), copy);
  if (sqlite3_deserialize(database.get(), "main", copy, size, size,
                          SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_READONLY) !=
      SQLITE_OK)
    ThrowInput("is not a database");
  return std::make_unique<Rosbag2Database>(std::move(database));
}

}  // namespace alidade
