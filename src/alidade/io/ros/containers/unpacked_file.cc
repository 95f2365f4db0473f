#include "alidade/io/ros/containers/unpacked_file.h"

#include <fcntl.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <new>

#include "alidade/base/error.h"
#include "alidade/io/ros/containers/byte_source.h"

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

void UnpackInto(int fd, const ByteSource& source) {
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
