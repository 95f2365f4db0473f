#include "alidade/io/files/spill_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <mutex>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"

namespace alidade {
namespace {

// An open file and its free places; shared by the store and its pieces.
class SpilledBytes {
 public:
  explicit SpilledBytes(int fd) : fd_(fd) {}
  ~SpilledBytes() { ::close(fd_); }
  SpilledBytes(const SpilledBytes&) = delete;
  SpilledBytes& operator=(const SpilledBytes&) = delete;

  // Where `bytes` were written; -1: there is no space.
  off_t Write(std::string_view bytes) {
    off_t at = -1;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      std::vector<off_t>& free = free_[bytes.size()];
      if (free.empty()) {
        at = end_;
        end_ += static_cast<off_t>(bytes.size());
      } else {
        at = free.back();
        free.pop_back();
      }
    }
    size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count =
          ::pwrite(fd_, bytes.data() + done, bytes.size() - done, at + static_cast<off_t>(done));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) {
        Free(at, bytes.size());
        return -1;
      }
      done += static_cast<size_t>(count);
    }
    return at;
  }

  void Read(off_t at, std::span<char> bytes) const {
    size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count =
          ::pread(fd_, bytes.data() + done, bytes.size() - done, at + static_cast<off_t>(done));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) {
        ThrowInput(std::string("frames that were moved from memory to the disk cannot be read "
                               "again: ") +
                   (count < 0 ? std::strerror(errno) : "the file ends"));
      }
      done += static_cast<size_t>(count);
    }
  }

  void Free(off_t at, size_t size) noexcept {
    try {
      const std::lock_guard<std::mutex> lock(mutex_);
      free_[size].push_back(at);
    } catch (...) {  // no memory: the place stays unused
    }
  }

 private:
  const int fd_;
  std::mutex mutex_;
  std::map<size_t, std::vector<off_t>> free_;  // by size
  off_t end_ = 0;
};

class SpilledPiece : public ByteStore::Piece {
 public:
  SpilledPiece(std::shared_ptr<SpilledBytes> file, off_t at, size_t size)
      : file_(std::move(file)), at_(at), size_(size) {}
  ~SpilledPiece() override { file_->Free(at_, size_); }
  void Read(std::span<char> bytes) const override { file_->Read(at_, bytes); }

 private:
  const std::shared_ptr<SpilledBytes> file_;
  const off_t at_;
  const size_t size_;
};

class SpillFile : public ByteStore {
 public:
  explicit SpillFile(int fd) : file_(std::make_shared<SpilledBytes>(fd)) {}
  std::unique_ptr<const Piece> Put(std::string_view bytes) override {
    const off_t at = file_->Write(bytes);
    if (at < 0) return nullptr;
    return std::make_unique<SpilledPiece>(file_, at, bytes.size());
  }

 private:
  const std::shared_ptr<SpilledBytes> file_;
};

}  // namespace

std::shared_ptr<ByteStore> MakeSpillFile(const std::string& folder) {
  const std::string path = TemporaryBeside(folder + "/frames");
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0) return nullptr;
  ::unlink(path.c_str());
  return std::make_shared<SpillFile>(fd);
}

}  // namespace alidade
