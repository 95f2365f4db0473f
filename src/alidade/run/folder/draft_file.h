// A file that grows while a program runs: written beside its place, and there, whole, once it is
// closed.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace alidade {

class DraftFile {
 public:
  // Throws Error (input) when it cannot be made. What an earlier program left beside `path` when it
  // was killed goes.
  explicit DraftFile(const std::string& path);
  ~DraftFile();  // without Close(): nothing stays
  DraftFile(const DraftFile&) = delete;
  DraftFile& operator=(const DraftFile&) = delete;

  // False when the disk is full or gone; nothing more is written then.
  bool Write(std::string_view bytes);
  void Close();  // throws Error (input) when not all of it could be written
  size_t bytes() const { return bytes_; }

 private:
  std::string path_, draft_;
  std::FILE* file_ = nullptr;
  size_t bytes_ = 0;
  bool failed_ = false;
};

}  // namespace alidade
