// A zstd file unpacked into a temporary file, which is removed on destruction. Databases need
// random access and so cannot be read from a compressed stream.
#pragma once

#include <string>

namespace alidade {

class UnpackedFile {
 public:
  // Unpacks into the folder for temporary files. Throws Error (input) when the file is damaged, the
  // result exceeds MostUnpackedFileFrom(), or it would take the last twentieth of the disk.
  explicit UnpackedFile(const std::string& packed);
  ~UnpackedFile();
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;  // set while fd_ is initialized
  int fd_;
};

}  // namespace alidade
