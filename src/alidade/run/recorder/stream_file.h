// The stream in a file: run.stream. 8 bytes "ALIDSTR1", then for each message its length (u32,
// little-endian), 4 zero bytes, and the message, filled up with zeros to a multiple of 8. A file
// that was cut off is good up to its last whole message.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "alidade/run/folder/draft_file.h"

namespace alidade {

// Written beside its place, and there once it is closed.
class StreamFileWriter {
 public:
  // Throws Error (input) when it cannot be made.
  explicit StreamFileWriter(const std::string& path);

  // False when the disk is full or gone; nothing more is written then.
  bool Write(std::string_view message);
  void Close() { file_.Close(); }  // throws Error (input) when not all of it could be written
  size_t bytes() const { return file_.bytes(); }

 private:
  DraftFile file_;
};

// Message by message.
class StreamFileReader {
 public:
  // Throws Error (input) when it cannot be read or is no stream.
  explicit StreamFileReader(const std::string& path);
  ~StreamFileReader();
  StreamFileReader(const StreamFileReader&) = delete;
  StreamFileReader& operator=(const StreamFileReader&) = delete;

  // Nothing at the end, or where the file was cut off.
  std::optional<std::string> Next();

 private:
  std::FILE* file_ = nullptr;
  size_t left_ = 0;  // bytes
};

}  // namespace alidade
