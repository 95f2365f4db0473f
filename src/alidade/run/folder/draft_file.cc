#include "alidade/run/folder/draft_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"

namespace alidade {

DraftFile::DraftFile(const std::string& path) : path_(path), draft_(TemporaryBeside(path)) {
  if (IsFolder(path)) ThrowInput(path + " is a folder; give the name of a file");
  std::error_code ignored;
  for (const std::string& left : StaleTemporaries(path)) std::filesystem::remove(left, ignored);
  file_ = std::fopen(draft_.c_str(), "wb");
  if (!file_) ThrowInput(path + ": cannot be written (" + std::strerror(errno) + ")");
  Occupy(fileno(file_));
}

DraftFile::~DraftFile() {
  if (!file_) return;
  std::fclose(file_);
  std::error_code error;
  std::filesystem::remove(draft_, error);
}

bool DraftFile::Write(std::string_view bytes) {
  if (failed_ || !file_) return false;
  failed_ = std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size();
  bytes_ += bytes.size();
  return !failed_;
}

void DraftFile::Close() {
  if (!file_) return;
  const bool closed = std::fclose(file_) == 0;
  file_ = nullptr;
  std::error_code error;
  if (closed && !failed_) std::filesystem::rename(draft_, path_, error);
  if (!closed || failed_ || error) {
    std::filesystem::remove(draft_, error);
    ThrowInput(path_ + ": could not be written completely (is the disk full?)");
  }
}

}  // namespace alidade
