#include "alidade/run/folder/folder_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"

namespace alidade {
namespace {

std::string ThisProcess() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return "process " + std::to_string(::getpid()) + " on " + host.data();
}

std::string LineIn(int fd) {
  std::array<char, 512> text{};
  const ssize_t size = ::pread(fd, text.data(), text.size(), 0);
  const std::string all(text.data(), static_cast<size_t>(size > 0 ? size : 0));
  const std::string line = all.substr(0, all.find('\n'));
  return line.empty() ? "another process" : line;
}

// Whether the locked file still has that name: the previous holder may have removed it.
bool IsAt(int fd, const std::string& path) {
  struct stat own {
  }, there{};
  return ::fstat(fd, &own) == 0 && ::stat(path.c_str(), &there) == 0 &&
         own.st_dev == there.st_dev && own.st_ino == there.st_ino;
}

}  // namespace

FolderLock::FolderLock(const std::string& file, const std::string& where) : file_(file) {
  while (true) {
    std::error_code error;
    std::filesystem::create_directories(std::filesystem::path(file).parent_path(), error);
    fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (fd_ < 0 && errno == ENOENT && !error) continue;  // the folder was removed meanwhile
    if (fd_ < 0) ThrowInput(where + "cannot write " + file + ": " + std::strerror(errno));
    if (!Occupy(fd_) && errno == EWOULDBLOCK) {
      const std::string holder = LineIn(fd_);
      ::close(fd_);
      ThrowInput(where + holder +
                 " is writing to this folder; wait until it ends, or choose another folder");
    }
    if (IsAt(fd_, file)) break;
    ::close(fd_);
  }
  const std::string line = ThisProcess() + "\n";
  // Without the name only a message is less precise.
  if (::ftruncate(fd_, 0) == 0) [[maybe_unused]]
    const ssize_t written = ::pwrite(fd_, line.data(), line.size(), 0);
}

FolderLock::~FolderLock() {
  if (IsAt(fd_, file_)) ::unlink(file_.c_str());
  ::close(fd_);
}

}  // namespace alidade
