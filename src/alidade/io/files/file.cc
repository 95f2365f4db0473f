#include "alidade/io/files/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "alidade/base/error.h"

namespace alidade {
namespace {

constexpr const char* kTemporary = ".tmp";  // temporary files are named PATH.tmpPID-NUMBER

// Closes a file descriptor on destruction.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  bool Close() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

bool WriteAll(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return true;
}

// Flushes the rename to the disk. Errors are ignored, because not all file systems can sync a
// folder.
void SyncFolderOf(const std::string& path) {
  const size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "."
                             : slash == 0               ? "/"
                                                        : path.substr(0, slash);
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) ::fsync(fd.get());
}

// A pipe the process was started with: its other end is open, so reading cannot block for ever.
bool WasHandedOver(const std::string& path) {
  return path.rfind("/dev/fd/", 0) == 0 || path.rfind("/proc/self/fd/", 0) == 0 ||
         path == "/dev/stdin";
}

void CheckEnds(const std::string& path, const struct stat& status) {
  const mode_t mode = status.st_mode;
  if (S_ISREG(mode) || (S_ISFIFO(mode) && WasHandedOver(path))) return;
  ThrowInput("cannot read " + path + ": it is " +
             (S_ISDIR(mode)    ? "a folder"
              : S_ISFIFO(mode) ? "a pipe"
              : S_ISSOCK(mode) ? "a socket"
                               : "a device") +
             ", not a file");
}

}  // namespace

std::string ReadFile(const std::string& path, size_t most_bytes) {
  return ReadFile(path, most_bytes, [](std::string_view) {});
}

std::string ReadFile(const std::string& path, size_t most_bytes, const StartCheck& check) {
  const auto fail = [&path] { ThrowInput("cannot read " + path + ": " + std::strerror(errno)); };
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) fail();
  CheckEnds(path, status);  // before open(), which would block until a pipe has a writer
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (fd.get() < 0 || ::fstat(fd.get(), &status) != 0) fail();
  CheckEnds(path, status);  // again: another file may have this name by now
  if (S_ISFIFO(status.st_mode)) ::fcntl(fd.get(), F_SETFL, 0);  // wait for the pipe's writer
  const auto check_size = [&](size_t size) {
    if (size <= most_bytes) return;
    ThrowInput(path + " is longer than " + std::to_string(most_bytes >> 20) +
               " MB, which is too long for such a file");
  };
  check_size(static_cast<size_t>(status.st_size));
  // The size is only a hint: pipes and files in /proc report 0.
  const auto hint = static_cast<size_t>(status.st_size > 0 ? status.st_size : 0) + 1;
  std::string bytes;
  bytes.resize(std::min(hint, kStartBytes));
  size_t used = 0;
  bool checked = false;
  while (true) {
    if (used == bytes.size()) {
      if (!std::exchange(checked, true)) check(bytes);
      bytes.resize(used < hint ? hint : 2 * used);
    }
    const ssize_t got = ::read(fd.get(), bytes.data() + used, bytes.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail();
    if (got == 0) break;
    used += static_cast<size_t>(got);
    check_size(used);
  }
  bytes.resize(used);
  if (!checked) check(bytes);
  return bytes;
}

void CheckIsFile(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0)
    ThrowInput("cannot read " + path + ": " + std::strerror(errno));
  CheckEnds(path, status);
}

bool IsFile(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode);
}

bool IsFolder(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode);
}

bool IsThere(const std::string& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0;
}

std::string NameAsTyped(const std::string& path) {
  const std::filesystem::path whole = std::filesystem::absolute(path).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

std::vector<std::string> NamesIn(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
    names.push_back(entry->path().filename().string());
  if (error) ThrowInput("cannot read the folder " + folder + ": " + error.message());
  return names;
}

std::string TemporaryBeside(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  return path + kTemporary + std::to_string(::getpid()) + "-" +
         std::to_string(counter.fetch_add(1));
}

bool Occupy(int fd) { return ::flock(fd, LOCK_EX | LOCK_NB) == 0; }

std::vector<std::string> StaleTemporaries(const std::string& path) {
  namespace fs = std::filesystem;
  const std::string stem = fs::path(path).filename().string() + kTemporary;
  const fs::path folder = fs::path(path).parent_path();
  std::vector<std::string> stale;
  std::error_code error;
  fs::directory_iterator entry(folder.empty() ? "." : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.compare(0, stem.size(), stem) != 0) continue;
    const std::string rest = name.substr(stem.size());  // must be PID-NUMBER
    const size_t dash = rest.find('-');
    const bool ours = dash != std::string::npos && dash > 0 && dash + 1 < rest.size() &&
                      rest.find_first_not_of("0123456789") == dash &&
                      rest.find_first_not_of("0123456789", dash + 1) == std::string::npos;
    if (!ours) continue;
    const Descriptor fd(::open(entry->path().c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
    if (fd.get() >= 0 && Occupy(fd.get())) stale.push_back(entry->path().string());
  }
  return stale;
}

namespace {

// Renaming onto a pipe or a device would replace it for every process (as root, even /dev/null).
void CheckReplaceable(const std::string& path) {
  struct stat status {};
  const bool stream =
      ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
  if (stream || WasHandedOver(path) || path == "/dev/stdout" || path == "/dev/stderr")
    ThrowInput("cannot write " + path + ": it is a pipe, a socket or a device, not a file");
}

}  // namespace

void AtomicWriteFile(const std::string& path, std::string_view bytes, Sync sync) {
  if (sync == Sync::kYes) {
    for (const std::string& left : StaleTemporaries(path)) ::unlink(left.c_str());
  }
  CheckReplaceable(path);
  std::string temporary = TemporaryBeside(path);
  const auto fail = [&path] {
    const int error = errno;
    ThrowInput("cannot write " + path + ": " + std::strerror(error));
  };
  const auto open_new = [&] {
    return ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  };
  int opened = open_new();
  // In containers the id of a killed process, and so its temporary's name, may be this process's.
  for (; opened < 0 && errno == EEXIST; opened = open_new()) temporary = TemporaryBeside(path);
  Descriptor fd(opened);
  if (fd.get() < 0) fail();
  Occupy(fd.get());  // without file locks the temporary of a killed program remains
  const bool written = WriteAll(fd.get(), bytes) && (sync == Sync::kNo || ::fsync(fd.get()) == 0) &&
                       fd.Close() && std::rename(temporary.c_str(), path.c_str()) == 0;
  if (!written) {
    const int error = errno;
    ::unlink(temporary.c_str());
    errno = error;
    fail();
  }
  if (sync == Sync::kYes) SyncFolderOf(path);
}

}  // namespace alidade
