// The file of a stream, run.stream: 8 bytes "ALIDSTR1", then for each message its length (u32,
// little-endian), 4 zero bytes and the message, padded with zeros to a multiple of 8. A truncated
// file is valid up to its last complete message.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "alidade/run/folder/draft_file.h"

namespace alidade {

// Written under a temporary name until it is closed.
class StreamFileWriter {
 public:
  // Throws Error (input) if it cannot be created.
  explicit StreamFileWriter(const std::string& path);

  // False if writing failed (disk full); nothing more is written then.
  bool Write(std::string_view message);
  void Close() { file_.Close(); }  // throws Error (input) if writing was incomplete
  size_t bytes() const { return file_.bytes(); }

 private:
  DraftFile file_;
};

// Reads message by message.
class StreamFileReader {
 public:
  // Throws Error (input) if it cannot be read or is not a stream.
  explicit StreamFileReader(const std::string& path);
  ~StreamFileReader();
  StreamFileReader(const StreamFileReader&) = delete;
  StreamFileReader& operator=(const StreamFileReader&) = delete;

  // nullopt at the end, also of a truncated file.
  std::optional<std::string> Next();

 private:
  std::FILE* file_ = nullptr;
  size_t left_ = 0;  // remaining bytes
};

}  // namespace alidade
