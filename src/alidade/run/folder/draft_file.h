// A file that is written while the program runs, under a temporary name in the same folder, and
// renamed when it is closed.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace alidade {

class DraftFile {
 public:
  // Throws Error (input) if it cannot be created. Removes temporary files of `path` that a killed
  // program left.
  explicit DraftFile(const std::string& path);
  ~DraftFile();  // without Close(): the file is removed
  DraftFile(const DraftFile&) = delete;
  DraftFile& operator=(const DraftFile&) = delete;

  // False if writing failed (disk full); nothing more is written then.
  bool Write(std::string_view bytes);
  void Close();  // throws Error (input) if writing was incomplete
  size_t bytes() const { return bytes_; }

 private:
  std::string path_, draft_;
  std::FILE* file_ = nullptr;
  size_t bytes_ = 0;
  bool failed_ = false;
};

}  // namespace alidade
