#include "alidade/io/ros/containers/unpacked_file.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <new>

#include "alidade/base/error.h"
#include "alidade/io/ros/containers/byte_source.h"
#include "alidade/io/ros/containers/unpack.h"

namespace alidade {
namespace {

// Creates a temporary file and stores its name in `path`.
int TemporaryFile(std::string& path) {
  std::error_code error;
  const std::string folder = std::filesystem::temp_directory_path(error).string();
  std::string pattern = (error ? "/tmp" : folder) + "/alidade-unpacked-XXXXXX";
  const int fd = ::mkstemp(pattern.data());
  if (fd < 0) ThrowInput("cannot be decompressed into " + folder + ": " + std::strerror(errno));
  path = pattern;
  return fd;
}

void WriteAllTo(int fd, const char* bytes, size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(fd, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0)
      ThrowInput(std::string("cannot be decompressed into the folder for temporary files (TMPDIR "
                             "chooses another): ") +
                 std::strerror(errno));
    bytes += written;
    count -= static_cast<size_t>(written);
  }
}

// Bytes that `fd`'s file system has besides the twentieth that is left free, at most 1 GB of it:
// other programs use the folder for temporary files, too.
uint64_t RoomAt(int fd) {
  struct statvfs disk {};
  if (::fstatvfs(fd, &disk) != 0) return std::numeric_limits<uint64_t>::max();
  const uint64_t block = disk.f_frsize, all = block * disk.f_blocks, free = block * disk.f_bavail;
  const uint64_t left = std::min<uint64_t>(all / 20, uint64_t{1} << 30);
  return free > left ? free - left : 0;
}

// Limits the size of the unpacked file: by its ratio to the packed one, and by the free disk.
class Budget {
 public:
  Budget(int fd, uint64_t packed) : fd_(fd), most_(MostUnpackedFileFrom(packed)) {}
  // Throws Error (input) when `count` more bytes are too many.
  void Take(uint64_t count) {
    used_ += count;
    if (used_ > most_) {
      ThrowInput(
          "unpacks to more than " + std::to_string(most_ >> 20) + " MB, over " +
          std::to_string(kMostFileRatio) +
          " times its size: it is damaged, or made to fill the disk. If it is to be trusted, "
          "unpack it with `zstd -d` and open the result");
    }
    if (used_ <= checked_) return;
    checked_ = used_ + kCheckEvery;
    if (RoomAt(fd_) < kCheckEvery) {
      ThrowInput(
          "unpacks to more than is free in the folder for temporary files, of which a "
          "twentieth is left free (TMPDIR chooses another folder)");
    }
  }

 private:
  static constexpr uint64_t kCheckEvery = uint64_t{1} << 20;  // bytes
  const int fd_;
  const uint64_t most_;
  uint64_t used_ = 0, checked_ = 0;
};

void UnpackInto(int fd, const ByteSource& source) {
  Budget budget(fd, source.Size());
  const std::unique_ptr<ZSTD_DStream, size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                        ZSTD_freeDStream);
  if (!stream) throw std::bad_alloc();
  std::string plain(ZSTD_DStreamOutSize(), '\0');
  constexpr uint64_t kPiece = 1 << 20;
  size_t hint = 1;
  for (uint64_t at = 0; at < source.Size(); at += kPiece) {
    const std::string packed = source.Read(at, std::min(kPiece, source.Size() - at));
    ZSTD_inBuffer in{packed.data(), packed.size(), 0};
    ZSTD_outBuffer out{plain.data(), plain.size(), 0};
    do {
      out.pos = 0;
      hint = ZSTD_decompressStream(stream.get(), &out, &in);
      if (ZSTD_isError(hint)) ThrowInput("is damaged: its zstd data cannot be decompressed");
      budget.Take(out.pos);
      WriteAllTo(fd, plain.data(), out.pos);
    } while (in.pos < in.size || out.pos == out.size);
  }
  // A truncated file is not an error here: its readers read the unpacked part as far as possible.
}

}  // namespace

// The file keeps its name until it is closed, because SQLite opens files by name.
UnpackedFile::UnpackedFile(const std::string& packed) : fd_(TemporaryFile(path_)) {
  try {
    UnpackInto(fd_, *OpenFileSource(packed));
  } catch (...) {
    ::close(fd_);
    ::unlink(path_.c_str());
    throw;
  }
}

UnpackedFile::~UnpackedFile() {
  ::close(fd_);
  ::unlink(path_.c_str());
}

}  // namespace alidade
