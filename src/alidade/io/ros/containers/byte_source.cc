#include "alidade/io/ros/containers/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "alidade/base/error.h"

namespace alidade {
namespace {

void CheckInside(uint64_t offset, uint64_t count, uint64_t size) {
  if (offset > size || count > size - offset) ThrowInput("is truncated");
}

class FileSource : public ByteSource {
 public:
  explicit FileSource(const std::string& path) : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat status {};
    if (fd_ < 0 || ::fstat(fd_, &status) != 0) {
      const int error = errno;
      if (fd_ >= 0) ::close(fd_);
      ThrowInput(std::string("cannot be read: ") + std::strerror(error));
    }
    size_ = static_cast<uint64_t>(status.st_size);
  }
  ~FileSource() override { ::close(fd_); }
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  uint64_t Size() const override { return size_; }

  std::string Read(uint64_t offset, uint64_t count) const override {
    CheckInside(offset, count, size_);
    std::string bytes(count, '\0');
    for (size_t used = 0; used < count;) {
      const ssize_t got =
          ::pread(fd_, bytes.data() + used, count - used, static_cast<off_t>(offset + used));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) ThrowInput(std::string("cannot be read: ") + std::strerror(errno));
      if (got == 0) ThrowInput("became shorter while it was read");
      used += static_cast<size_t>(got);
    }
    return bytes;
  }

 private:
  int fd_;
  uint64_t size_ = 0;
};

class TextSource : public ByteSource {
 public:
  explicit TextSource(std::string_view bytes) : bytes_(bytes) {}
  uint64_t Size() const override { return bytes_.size(); }
  std::string Read(uint64_t offset, uint64_t count) const override {
    CheckInside(offset, count, bytes_.size());
    return std::string(bytes_.substr(offset, count));
  }

 private:
  std::string_view bytes_;
};

}  // namespace

std::unique_ptr<ByteSource> OpenFileSource(const std::string& path) {
  return std::make_unique<FileSource>(path);
}

std::unique_ptr<ByteSource> SourceOfBytes(std::string_view bytes) {
  return std::make_unique<TextSource>(bytes);
}

}  // namespace alidade
