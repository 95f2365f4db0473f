// A packed file (zstd) as a plain one that is gone afterwards: databases cannot be read in pieces
// out of a stream.
#pragma once

#include <string>

namespace alidade {

class UnpackedFile {
 public:
  // Into the folder for temporary files. Throws Error (input) when it is damaged, or the disk full.
  explicit UnpackedFile(const std::string& packed);
  ~UnpackedFile();
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;  // set while fd_ is made
  int fd_;
};

}  // namespace alidade
